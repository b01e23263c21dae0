// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/detail/number_type.h"
#include "subvol/detail/text_scanner.h"

namespace subvol::detail {

/// The faces of a mesh: those of face f are points[ends[f - 1]] to points[ends[f] - 1].
struct FoamFaces {
    std::vector<std::size_t> ends;
    std::vector<std::int64_t> points;

    [[nodiscard]] std::size_t size() const { return ends.size(); }
    [[nodiscard]] std::span<const std::int64_t> operator[](std::size_t f) const {
        const std::size_t begin = f == 0 ? 0 : ends[f - 1];
        return std::span(points).subspan(begin, ends[f] - begin);
    }
};

/// A patch. Its faces are `count` from `first` on.
struct FoamPatch {
    std::string name;
    std::string type = {};  ///< such as wall or processor
    std::int64_t first = 0, count = 0;
    std::int64_t neighbour = -1;           ///< the processor behind a patch where the mesh was cut, else -1
    std::vector<std::string> groups = {};  ///< groups that it belongs to
};

/// What a field is on a patch.
struct FoamOnPatch {
    bool along = false;               ///< a vector has no component along the normal
    std::vector<double> values = {};  ///< values for each face; empty: unknown
    bool level = false;               ///< the field does not change across the faces
};

struct FoamZone {
    std::string name;
    std::vector<std::int64_t> labels;
};

/// A file of OpenFOAM: its header and the list or field that follows, as text or in binary numbers of the widths that the
/// header gives. Every failure is an Error(InvalidInput) that names the file and the line, in binary files the byte.
class FoamText {
public:
    /// Reads the file, or the one with .gz, and its header.
    ///
    /// most_entries: that a list of the file can have, as others say
    /// block:        of a file that has the blocks of several processors (class decomposedBlockData), the one that is read
    explicit FoamText(const std::filesystem::path& path, std::size_t most_entries = std::numeric_limits<std::size_t>::max(),
                      std::optional<std::size_t> block = {});
    FoamText(const FoamText&) = delete;
    FoamText& operator=(const FoamText&) = delete;

    /// The header's class, such as volScalarField.
    [[nodiscard]] const std::string& type() const { return type_; }
    /// Returns the size of the unpacked text in bytes.
    [[nodiscard]] std::size_t size() const { return text_.size(); }

    /// How many blocks a file of several processors has; 0 for any other file.
    [[nodiscard]] std::size_t blocks();

    [[nodiscard]] std::vector<std::int64_t> labels();
    /// Numbers, `components` for each entry. expected: entries that may be one value repeated, however short the file
    [[nodiscard]] std::vector<double> reals(std::size_t components, std::size_t expected = 0);
    [[nodiscard]] FoamFaces faces();

    /// The patches of the file `boundary`.
    [[nodiscard]] std::vector<FoamPatch> patches();
    /// The lists of labels of the file `cellZones`. key: of the list in each zone, cellLabels
    [[nodiscard]] std::vector<FoamZone> zones(std::string_view key);

    /// The internalField of a field file, for so many cells. Entries before it and in files that it includes are what $names of
    /// its value stand for; what has to be computed (#calc) is refused.
    [[nodiscard]] std::vector<double> internal_field(std::size_t components, std::size_t cells);

    /// The boundaryField that follows, for each of the patches. After internal_field
    [[nodiscard]] std::vector<FoamOnPatch> boundary_field(std::size_t components, std::span<const FoamPatch> patches);

    /// The unit that the `dimensions` before the internalField say, such as "m/s"; empty if there are none. After
    /// internal_field
    [[nodiscard]] std::string unit() const;

    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const;

private:
    void skip_space();
    /// A word, or one of the marks ( ) { } [ ] ;. Empty at the end.
    std::string_view token();
    void expect(std::string_view mark);
    double number();
    std::int64_t label();
    /// The count before a list. width: of an entry in bytes; expected: allowed in any case
    std::size_t count(std::size_t width, std::size_t expected = 0);
    std::string_view bytes(std::size_t size);
    void read_header();
    void take_block(std::size_t block);
    /// Calls entry(name, key) for each entry of each dictionary in a list of named ones, before the entry's value, of which it
    /// may read some; goes on behind the entry.
    template <class Entry>
    void each_entry(const Entry& entry);
    /// Goes to the internalField, and keeps the entries before it.
    void find_internal_field(int depth);
    void include(const std::filesystem::path& path, int depth);
    /// Reads the text up to the next semicolon, and goes there.
    std::vector<double> uniform_value(std::size_t components);
    /// The rest of an entry; lists in binary are passed by their size.
    void skip_entry();
    struct PatchEntry;
    PatchEntry patch_entry(std::string key, std::size_t components);
    std::vector<double> patch_value(std::size_t components, bool& uniform);
    [[nodiscard]] std::string expanded(std::string_view text) const;
    /// left: how many names may still be replaced
    [[nodiscard]] std::string expanded(std::string_view text, int depth, std::size_t& left) const;
    [[nodiscard]] NumberType label_type() const { return wide_labels_ ? NumberType::Int64 : NumberType::Int32; }
    [[nodiscard]] NumberType real_type() const { return wide_reals_ ? NumberType::Float64 : NumberType::Float32; }
    void read_tuple(std::size_t components, std::vector<double>& values);

    std::string file_, text_;
    std::size_t next_ = 0;
    std::map<std::string, std::string, std::less<>> entries_;
    std::string type_;
    bool binary_ = false, wide_labels_ = false, wide_reals_ = true;
    std::endian order_ = std::endian::little;
};

}  // namespace subvol::detail
