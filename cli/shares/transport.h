// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "part_note.h"
#include "ranks.h"
#include "subvol/facts.h"
#include "subvol/progress.h"

namespace subvol::cli {

// A work that can be divided makes a part for each share, and joins all parts to the whole. How parts come together is the
// same for every work:
//
//     alone    the one part is the whole
//     files    --part K/N stores a part with a note; `join` loads all parts, puts them in order by their notes, and joins them
//     ranks    each rank sends its part to rank 0, which joins them
//
// A kind of part says what it needs of the work, by these names:
//
//     Made, Whole                    what a share makes, and what all shares make together
//     Whole join(std::vector<Made> parts, std::span<const std::string> names)    in the order of shares; names: for errors
//     std::string pack(Made)         as bytes, for ranks
//     Made unpack(const std::string& bytes)
//     Facts store(Made, const std::string& note)    writes a file with a note
//     OpenedPart<Made> open(const std::string& file)

/// How the part that this process makes comes to the others.
struct Transport {
    Share share{};
    std::optional<PartNote> note{};  ///< the note in the part's file; none: the part is not written to a file
    Ranks* ranks = nullptr;          ///< the ranks that make the other parts; null: there are none
    Progress* progress = nullptr;
};

/// Joins a part with those of the ranks.
///
/// ranks:   null: the part is all there is
/// returns: the whole; nothing except at rank 0
template <class Kind>
[[nodiscard]] WithFacts<std::optional<typename Kind::Whole>> join_ranks(const Kind& kind, typename Kind::Made own, Ranks* ranks,
                                                                        Progress* progress) {
    WithFacts<std::optional<typename Kind::Whole>> result{};
    std::vector<typename Kind::Made> parts;
    std::vector<std::string> names{"rank 0"};
    if (ranks == nullptr) {
        parts.push_back(std::move(own));
        result.value = kind.join(std::move(parts), names);
        return result;
    }
    result.facts.timed(progress, "gather", [&] {
        for (std::string& bytes : ranks->gather(kind.pack(std::move(own)))) {
            parts.push_back(kind.unpack(bytes));
            bytes = {};
        }
    });
    if (!ranks->first()) return result;
    for (int rank = 1; rank < ranks->size(); ++rank) names.push_back("rank " + std::to_string(rank));
    result.value = result.facts.timed(progress, "join", [&] { return kind.join(std::move(parts), names); });
    return result;
}

/// Stores a part, sends it, or joins it.
///
/// returns: the whole, if this process has all parts
template <class Kind>
[[nodiscard]] WithFacts<std::optional<typename Kind::Whole>> deliver(const Kind& kind, typename Kind::Made own,
                                                                     const Transport& transport) {
    if (!transport.note) return join_ranks(kind, std::move(own), transport.ranks, transport.progress);
    WithFacts<std::optional<typename Kind::Whole>> result{};
    result.facts["part"] = transport.share.name();
    result.facts.merge(kind.store(std::move(own), text_of(*transport.note)));
    return result;
}

/// A part in a file.
template <class Made>
struct OpenedPart {
    std::optional<std::string> note;  ///< the note in the file; none: the file has none
    std::function<Made()> read;       ///< reads the part; to be called once
};

/// A whole that was joined from files, and what the note of the first part says of how it is to be written.
template <class Whole>
struct JoinedFiles {
    Whole whole;
    nlohmann::ordered_json how;
};

/// Joins the parts in some files, in any order. What their notes say is checked before the parts are read.
///
/// throws: Error(InvalidInput) as `order_of`, and as the kind opens, reads and joins
template <class Kind>
[[nodiscard]] WithFacts<JoinedFiles<typename Kind::Whole>> join_files(const Kind& kind, std::span<const std::string> files,
                                                                      Progress* progress) {
    Facts facts;
    std::vector<typename Kind::Made> parts;
    std::vector<FoundPart> found;
    std::vector<std::string> names;
    facts.timed(progress, "read", [&] {
        std::vector<OpenedPart<typename Kind::Made>> opened;
        for (const std::string& file : files) {
            opened.push_back(kind.open(file));
            if (!opened.back().note) refuse_whole(file);
            found.push_back({file, note_from(*opened.back().note, file)});
        }
        for (const std::size_t number : order_of(found)) {
            parts.push_back(opened[number].read());
            names.push_back(files[number]);
        }
    });
    auto whole = facts.timed(progress, "join", [&] { return kind.join(std::move(parts), names); });
    return {{std::move(whole), std::move(found.front().note.how)}, std::move(facts)};
}

}  // namespace subvol::cli
