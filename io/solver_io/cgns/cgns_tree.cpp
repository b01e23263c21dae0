// SPDX-License-Identifier: Apache-2.0
#include "cgns_tree.h"

#include "subvol/detail/printable.h"

namespace subvol::detail {

namespace {

std::string without_padding(const std::string& text) {
    const std::string whole = text.substr(0, text.find('\0'));
    const std::size_t last = whole.find_last_not_of(' ');
    return last == std::string::npos ? std::string() : whole.substr(0, last + 1);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> CgnsTree::labelled_children(const std::string& node) const {
    std::vector<std::pair<std::string, std::string>> found;
    for (const std::string& name : file_.names(node.empty() ? "/" : node)) {
        if (name.empty() || name.front() == ' ') continue;  // the node's own data
        std::string path = node + "/" + name;
        std::string label = without_padding(file_.text(path, "label").value_or(""));
        found.emplace_back(std::move(path), std::move(label));
    }
    return found;
}

std::vector<std::string> CgnsTree::children(const std::string& node, const std::string& label) const {
    std::vector<std::string> found;
    for (auto& [path, of_child] : labelled_children(node)) {
        if (of_child == label) found.push_back(std::move(path));
    }
    return found;
}

std::optional<std::string> CgnsTree::child(const std::string& node, const std::string& label) const {
    const auto all = children(node, label);
    return all.empty() ? std::nullopt : std::optional(all.front());
}

std::size_t CgnsTree::all_rows(const std::string& node) const {
    if (!has_data(node)) file_.fail("node " + in_quotes(node) + " has no data of numbers");
    return file_.rows(node + kData);
}

std::vector<double> CgnsTree::reals(const std::string& node) const {
    return file_.reals(node + kData, 0, all_rows(node));
}

std::vector<std::int64_t> CgnsTree::integers(const std::string& node) const {
    return file_.integers(node + kData, 0, all_rows(node));
}

std::string CgnsTree::text(const std::string& node) const {
    if (!has_data(node)) return {};
    std::string text;
    for (const std::int64_t character : integers(node)) text += static_cast<char>(character);
    return without_padding(text);
}

std::vector<std::string> CgnsTree::texts(const std::string& node) const {
    constexpr std::size_t kOfName = 32;
    std::string all;
    for (const std::int64_t character : integers(node)) all += static_cast<char>(character);
    std::vector<std::string> texts;
    for (std::size_t at = 0; at + kOfName <= all.size(); at += kOfName)
        texts.push_back(without_padding(all.substr(at, kOfName)));
    return texts;
}

}  // namespace subvol::detail
