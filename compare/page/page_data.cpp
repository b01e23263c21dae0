// SPDX-License-Identifier: Apache-2.0
#include "page_data.h"

#include <algorithm>
#include <cmath>

#include "page_kernels.h"
#include "subvol/rbf_field.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kPlaces = 8192;  // at which errors are measured

/// Places in the kernels of a volume: off their middles, where sums of few kernels are not typical.
std::vector<Vec3> places_in(const RbfVolume& volume) {
    const std::size_t step = std::max<std::size_t>(1, volume.size() / kPlaces);
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < volume.size(); i += step) {
        const std::size_t other = std::min(i + 1, volume.size() - 1);
        const Vec3 d = volume.centers[other] - volume.centers[i];
        const Mat3 inverse = glm::inverse(matrix(volume.frames[i]));
        const bool near = glm::dot(d, inverse * d) < 1;  // the next kernel in the list is often the next one in space
        places.push_back(volume.centers[i] + (near ? 0.5 : 0.0) * d);
    }
    return places;
}

struct ErrorSum {
    double squares = 0, most = 0;
    std::size_t count = 0;

    void add(const RbfVolume& given, std::size_t channel, const RbfVolume& kept) {
        const std::vector<Vec3> places = places_in(given);
        const std::vector<double> right = RbfField(given, {.channel = channel}).evaluate(places);
        const std::vector<double> found = RbfField(kept).evaluate(places);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const double error = std::abs(found[i] - right[i]);
            if (!std::isfinite(error)) continue;
            squares += error * error;
            most = std::max(most, error);
            ++count;
        }
    }
};

template <class Item>
bool same(const std::vector<Item>& a, const std::vector<Item>& b) {
    return a == b;
}

/// Steps often have the same mesh: its places are stored once.
class Places {
public:
    Places(PageArrays& arrays, int bits) : arrays_(arrays), bits_(bits) {}

    /// The number of the array for these kernels, and what the page will read from it.
    int of(const RbfVolume& volume) {
        if (known_ && same(volume.centers, centers_) && same(volume.frames, frames_)) return number_;
        numbers_ = place_numbers(volume);
        number_ = arrays_.add(numbers_, kPlaceNumbers, bits_);
        centers_ = volume.centers;
        frames_ = volume.frames;
        known_ = true;
        return number_;
    }
    [[nodiscard]] const std::vector<double>& numbers() const { return numbers_; }

private:
    PageArrays& arrays_;
    int bits_, number_ = -1;
    bool known_ = false;
    std::vector<double> numbers_;
    std::vector<Vec3> centers_;
    std::vector<Symmetric3> frames_;
};

class Boundaries {
public:
    explicit Boundaries(PageArrays& arrays) : arrays_(arrays) {}

    PageJson of(const Surface& surface) {
        if (points_ < 0 || !same(surface.points, last_.points)) {
            std::vector<double> numbers;
            for (const Vec3& p : surface.points) numbers.insert(numbers.end(), {p.x, p.y, p.z});
            points_ = arrays_.add(numbers, 3, 16);
        }
        if (triangles_ < 0 || !same(surface.triangles, last_.triangles)) {
            std::vector<std::uint32_t> corners;
            for (const auto& t : surface.triangles) corners.insert(corners.end(), t.begin(), t.end());
            triangles_ = arrays_.add_integers(corners, 3);
        }
        last_ = surface;
        return {{"points", points_}, {"triangles", triangles_}};
    }

private:
    PageArrays& arrays_;
    Surface last_;
    int points_ = -1, triangles_ = -1;
};

}  // namespace

PageData page_data(std::span<const PageStep> steps, std::size_t fields, const PageRounding& rounding, bool with_errors) {
    PageData data;
    PageArrays arrays;
    Places places(arrays, rounding.place_bits);
    Boundaries boundaries(arrays);
    std::vector<ErrorSum> errors(fields);
    data.json["steps"] = PageJson::array();
    for (const PageStep& step : steps) {
        const std::size_t given = step.volume.size();
        const auto kept = static_cast<std::size_t>(std::llround(rounding.kept * static_cast<double>(given)));
        const bool merge = rounding.kept < 1;
        const RbfVolume merged = merge ? merged_kernels(step.volume, kept) : RbfVolume{};
        const RbfVolume& volume = merge ? merged : step.volume;
        PageJson entry{
            {"label", step.label}, {"places", places.of(volume)}, {"boundary", boundaries.of(step.boundary.surface)}};
        for (std::size_t f = 0; f < fields; ++f) {
            std::vector<double> values = value_numbers(volume, volume.channels[f]);
            std::vector<double> surface = step.boundary.values[f];
            entry["values"].push_back(
                {{"kernels", arrays.add(values, kValueNumbers, rounding.value_bits)}, {"surface", arrays.add(surface, 1, 16)}});
            if (!with_errors) continue;
            errors[f].add(step.volume, f, kernels_of_numbers(places.numbers(), values, volume.kernel));
        }
        data.json["steps"].push_back(std::move(entry));
        data.kernels += given;
        data.kept += volume.size();
        data.triangles += step.boundary.surface.triangles.size();
    }
    data.json["arrays"] = arrays.directory();
    data.compressed = arrays.compressed();
    for (const ErrorSum& error : errors) {
        const double count = static_cast<double>(std::max<std::size_t>(error.count, 1));
        data.errors.push_back({std::sqrt(error.squares / count), error.most});
    }
    return data;
}

}  // namespace subvol::detail
