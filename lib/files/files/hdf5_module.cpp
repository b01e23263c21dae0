// SPDX-License-Identifier: Apache-2.0
// The module subvol_hdf5.so: HDF5's library, which is 5 MB and brings those of compression and of the network. It offers a
// table of functions with plain types; identifiers of the library other than that of the file live within one call.
//
//     read     open → names of a group, shape of a dataset, texts and integers of attributes → a block of a dataset → close
//     write    create → groups, datasets, attributes → finish, which tells whether all was written
//
// A file that is read is not trusted. Links to other files are refused, and values that are stored outside of the file have no
// type. Before a block is read, its large chunks are looked at: one with more stored bytes than its values could need is
// refused, and one that was compressed by deflate is inflated piece by piece, to see that it does not become more than its
// values. Files that are written hold no times, so that the same contents are the same bytes; values are in chunks of about
// 1 MB, shuffled and deflated.
#include <hdf5.h>
#include <zlib.h>
#include <algorithm>
#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "hdf5_functions.h"
#include "subvol/detail/number_type.h"
#include "subvol/version.h"

namespace subvol::detail {

namespace {

// An identifier of the library, with the function that closes it.
class Handle {
public:
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    ~Handle() { (void)shut(); }

    // Closes it now. What was written to a dataset may reach the file only then: false if that failed, or if there is none.
    [[nodiscard]] bool shut() {
        const hid_t id = std::exchange(id_, -1);
        return id >= 0 && close_(id) >= 0;
    }

    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    operator hid_t() const { return id_; }

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

herr_t refuse_file(const char*, const char*, const char*, const char*, unsigned*, hid_t, void*) {
    return -1;
}

// A link could name any file of this machine.
hid_t in_this_file(hid_t kind) {
    const hid_t properties = H5Pcreate(kind);
    H5Pset_elink_cb(properties, refuse_file, nullptr);
    return properties;
}

std::int64_t open(const char* path) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // it prints what went wrong
    const Handle properties(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fclose_degree(properties, H5F_CLOSE_STRONG);
#if H5_VERSION_GE(1, 10, 7)
    H5Pset_file_locking(properties, false, true);  // a file system may not allow it, and nothing is written
#endif
    return H5Fopen(path, H5F_ACC_RDONLY, properties);
}

void close(std::int64_t file) {
    H5Fclose(file);
}

hid_t open_dataset(hid_t file, const char* path) {
    const Handle access(in_this_file(H5P_DATASET_ACCESS), H5Pclose);
    return H5Dopen2(file, path, access);
}

struct NameTaker {
    void* into;
    void (*take)(void* into, const char* name);
};

herr_t take_name(hid_t, const char* name, const H5L_info_t*, void* data) {
    const auto& taker = *static_cast<const NameTaker*>(data);
    taker.take(taker.into, name);
    return 0;
}

int each_name(std::int64_t file, const char* path, void* into, void (*take)(void* into, const char* name)) {
    const Handle access(in_this_file(H5P_GROUP_ACCESS), H5Pclose);
    const Handle group(H5Gopen2(file, path, access), H5Gclose);
    if (group < 0) return -1;
    NameTaker taker{into, take};
    return H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, take_name, &taker);
}

// The library's type for a number, in this machine's byte order.
hid_t native_type(NumberType type) {
    switch (type) {
        case NumberType::Int8:
            return H5T_NATIVE_INT8;
        case NumberType::UInt8:
            return H5T_NATIVE_UINT8;
        case NumberType::Int16:
            return H5T_NATIVE_INT16;
        case NumberType::UInt16:
            return H5T_NATIVE_UINT16;
        case NumberType::Int32:
            return H5T_NATIVE_INT32;
        case NumberType::UInt32:
            return H5T_NATIVE_UINT32;
        case NumberType::Int64:
            return H5T_NATIVE_INT64;
        case NumberType::UInt64:
            return H5T_NATIVE_UINT64;
        case NumberType::Float32:
            return H5T_NATIVE_FLOAT;
        case NumberType::Float64:
            return H5T_NATIVE_DOUBLE;
    }
    return -1;
}

int number_type(hid_t type) {
    const std::size_t size = H5Tget_size(type);
    if (H5Tget_class(type) == H5T_FLOAT) return static_cast<int>(size <= 4 ? NumberType::Float32 : NumberType::Float64);
    if (H5Tget_class(type) != H5T_INTEGER) return -1;
    const bool has_sign = H5Tget_sign(type) == H5T_SGN_2;
    switch (size) {
        case 1:
            return static_cast<int>(has_sign ? NumberType::Int8 : NumberType::UInt8);
        case 2:
            return static_cast<int>(has_sign ? NumberType::Int16 : NumberType::UInt16);
        case 4:
            return static_cast<int>(has_sign ? NumberType::Int32 : NumberType::UInt32);
        case 8:
            return static_cast<int>(has_sign ? NumberType::Int64 : NumberType::UInt64);
        default:
            return -1;
    }
}

// Whether each value is one character.
bool is_character(hid_t type) {
    return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 && H5Tget_size(type) == 1;
}

// The bytes of a chunk; 0 if there are no chunks.
std::uint64_t chunk_bytes(hid_t properties, hid_t type) {
    std::array<hsize_t, H5S_MAX_RANK> lengths{};
    const int rank = H5Pget_layout(properties) == H5D_CHUNKED ? H5Pget_chunk(properties, H5S_MAX_RANK, lengths.data()) : 0;
    if (rank <= 0) return 0;
    std::uint64_t bytes = H5Tget_size(type);
    for (int d = 0; d < rank; ++d) bytes *= lengths[static_cast<std::size_t>(d)];  // below 2^32, as the library demands
    return bytes;
}

// Whether what deflate made of some bytes becomes at most `most` bytes.
bool inflates_to(std::size_t most, std::vector<Bytef>& packed, std::size_t size) {
    std::vector<Bytef> piece(1 << 16);
    z_stream stream{};
    if (inflateInit(&stream) != Z_OK) return false;
    stream.next_in = packed.data();
    stream.avail_in = static_cast<uInt>(size);  // of a chunk, below 2^32
    int status = Z_OK;
    while (status == Z_OK && stream.total_out <= most) {
        stream.next_out = piece.data();
        stream.avail_out = static_cast<uInt>(piece.size());
        status = inflate(&stream, Z_NO_FLUSH);
    }
    const bool sound = stream.total_out <= most;  // what is damaged is found by the library
    inflateEnd(&stream);
    return sound;
}

// The library decompresses a chunk to its end, however much that is and however few numbers the chunk has: a megabyte becomes a
// gigabyte. Chunks that may become that large are decompressed without being kept first.
bool chunk_is_sound(hid_t dataset, hid_t properties, const hsize_t* place, std::size_t bytes) {
    constexpr std::size_t kMostOfDeflate = 1040, kHarmless = std::size_t{64} << 20, kOfFilters = 1 << 12;
    hsize_t stored = 0;
    if (H5Dget_chunk_storage_size(dataset, place, &stored) < 0 || stored <= kHarmless / kMostOfDeflate) return true;
    if (stored > bytes + bytes / 64 + kOfFilters) return false;
    std::vector<Bytef> packed(stored);
    std::uint32_t left_out = 0;
    if (H5Dread_chunk(dataset, H5P_DEFAULT, place, &left_out, packed.data()) < 0) return false;
    std::size_t size = stored;
    for (int f = H5Pget_nfilters(properties) - 1; f >= 0; --f) {
        if ((left_out >> f & 1U) != 0) continue;
        const H5Z_filter_t filter =
            H5Pget_filter2(properties, static_cast<unsigned>(f), nullptr, nullptr, nullptr, 0, nullptr, nullptr);
        if (filter == H5Z_FILTER_DEFLATE) return inflates_to(bytes + kOfFilters, packed, size);
        if (filter != H5Z_FILTER_FLETCHER32) break;  // another compression
        size -= std::min<std::size_t>(size, 4);
    }
    return true;
}

// The same of all chunks that a block of values touches.
bool chunks_are_sound(hid_t dataset, hid_t properties, hid_t type, const std::array<hsize_t, Hdf5Shape::kMostRank>& first,
                      const std::array<hsize_t, Hdf5Shape::kMostRank>& count) {
    if (H5Pget_layout(properties) != H5D_CHUNKED || H5Pget_nfilters(properties) <= 0) return true;
    std::array<hsize_t, Hdf5Shape::kMostRank> chunk{}, place{};
    const int rank = H5Pget_chunk(properties, Hdf5Shape::kMostRank, chunk.data());
    if (rank <= 0 || rank > static_cast<int>(Hdf5Shape::kMostRank)) return false;
    const auto dimensions = static_cast<std::size_t>(rank);
    const std::size_t bytes = chunk_bytes(properties, type);
    for (std::size_t d = 0; d < dimensions; ++d) {
        if (count[d] == 0) return true;
        place[d] = first[d] / chunk[d] * chunk[d];
    }
    for (;;) {
        if (!chunk_is_sound(dataset, properties, place.data(), bytes)) return false;
        std::size_t d = dimensions;
        while (d > 0) {
            --d;
            place[d] += chunk[d];
            if (place[d] < first[d] + count[d]) break;
            place[d] = first[d] / chunk[d] * chunk[d];
            if (d == 0) return true;
        }
    }
}

std::uint64_t address_of(hid_t dataset) {
#if H5_VERSION_GE(1, 12, 0)
    H5O_info2_t about{};
    if (H5Oget_info3(dataset, &about, H5O_INFO_BASIC) < 0) return 0;
    std::uint64_t address = 0;
    std::memcpy(&address, &about.token, sizeof address);
    return address;
#else
    H5O_info_t about{};
    return H5Oget_info(dataset, &about) < 0 ? 0 : about.addr;
#endif
}

// Whether its values are in this file.
bool is_here(hid_t properties) {
    const H5D_layout_t layout = H5Pget_layout(properties);
    return (layout == H5D_COMPACT || layout == H5D_CONTIGUOUS || layout == H5D_CHUNKED) &&
           H5Pget_external_count(properties) == 0;
}

int shape(std::int64_t file, const char* path, Hdf5Shape* into) {
    const Handle dataset(open_dataset(file, path), H5Dclose);
    if (dataset < 0) return -1;
    const Handle space(H5Dget_space(dataset), H5Sclose), type(H5Dget_type(dataset), H5Tclose);
    const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
    if (space < 0 || type < 0 || properties < 0) return -1;
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 0 || rank > static_cast<int>(Hdf5Shape::kMostRank)) return -1;
    std::array<hsize_t, Hdf5Shape::kMostRank> lengths{}, longest{};
    if (H5Sget_simple_extent_dims(space, lengths.data(), longest.data()) < 0) return -1;
    into->characters = is_character(type);
    const int values = into->characters ? static_cast<int>(NumberType::UInt8) : number_type(type);
    into->type = is_here(properties) ? values : -1;
    into->grows = rank > 0 && longest[0] == H5S_UNLIMITED;
    into->rank = static_cast<unsigned>(rank);
    std::copy(lengths.begin(), lengths.end(), into->lengths);
    into->stored = H5Dget_storage_size(dataset);
    into->filtered = H5Pget_nfilters(properties) != 0;
    into->chunk = chunk_bytes(properties, type);
    into->address = address_of(dataset);
    return 0;
}

int read(std::int64_t file, const char* path, unsigned rank, const std::uint64_t* starts, const std::uint64_t* lengths,
         void* into) {
    const Handle dataset(open_dataset(file, path), H5Dclose);
    if (dataset < 0) return -1;
    const Handle space(H5Dget_space(dataset), H5Sclose), type(H5Dget_type(dataset), H5Tclose);
    const int number = number_type(type);
    const hid_t values = is_character(type) ? type : number < 0 ? -1 : native_type(static_cast<NumberType>(number));
    if (values < 0 || H5Sget_simple_extent_ndims(space) != static_cast<int>(rank)) return -1;
    if (rank == 0) return H5Dread(dataset, values, H5S_ALL, H5S_ALL, H5P_DEFAULT, into);
    std::array<hsize_t, Hdf5Shape::kMostRank> first{}, count{};
    std::copy_n(starts, rank, first.begin());
    std::copy_n(lengths, rank, count.begin());
    const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
    if (!chunks_are_sound(dataset, properties, type, first, count)) return -1;
    if (H5Sselect_hyperslab(space, H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr) < 0) return -1;
    const Handle memory(H5Screate_simple(static_cast<int>(rank), count.data(), nullptr), H5Sclose);
    return H5Dread(dataset, values, memory, space, H5P_DEFAULT, into);
}

hid_t open_attribute(hid_t file, const char* object, const char* name) {
    const Handle access(in_this_file(H5P_LINK_ACCESS), H5Pclose);
    return H5Aopen_by_name(file, object, name, H5P_DEFAULT, access);
}

std::int64_t text(std::int64_t file, const char* object, const char* name, char* into, std::size_t most) {
    const Handle attribute(open_attribute(file, object, name), H5Aclose);
    if (attribute < 0) return -1;
    const Handle type(H5Aget_type(attribute), H5Tclose), space(H5Aget_space(attribute), H5Sclose);
    if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) return -1;
    if (H5Tis_variable_str(type) > 0) {
        char* found = nullptr;
        if (H5Aread(attribute, type, &found) < 0 || found == nullptr) return -1;
        const std::size_t length = std::min(std::strlen(found), most);
        std::copy_n(found, length, into);
        H5free_memory(found);
        return static_cast<std::int64_t>(length);
    }
    const std::size_t size = H5Tget_size(type);
    if (size == 0 || size > most || H5Aread(attribute, type, into) < 0) return -1;
    return static_cast<std::int64_t>(std::find(into, into + size, '\0') - into);
}

// reals: too
std::int64_t numbers(std::int64_t file, const char* object, const char* name, hid_t native, bool reals, void* into,
                     std::size_t most) {
    const Handle attribute(open_attribute(file, object, name), H5Aclose);
    if (attribute < 0) return -1;
    const Handle type(H5Aget_type(attribute), H5Tclose), space(H5Aget_space(attribute), H5Sclose);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    const H5T_class_t kind = H5Tget_class(type);
    if (kind != H5T_INTEGER && !(reals && kind == H5T_FLOAT)) return -1;
    if (count < 0 || static_cast<std::size_t>(count) > most) return -1;
    return H5Aread(attribute, native, into) < 0 ? -1 : count;
}

std::int64_t integers(std::int64_t file, const char* object, const char* name, std::int64_t* into, std::size_t most) {
    return numbers(file, object, name, H5T_NATIVE_INT64, false, into, most);
}

std::int64_t reals(std::int64_t file, const char* object, const char* name, double* into, std::size_t most) {
    return numbers(file, object, name, H5T_NATIVE_DOUBLE, true, into, most);
}

std::int64_t create(const char* path) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    const Handle properties(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fclose_degree(properties, H5F_CLOSE_STRONG);
#if H5_VERSION_GE(1, 10, 7)
    H5Pset_file_locking(properties, false, true);
#endif
    return H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, properties);
}

// Objects without the time at which they were made: the same contents are the same bytes.
hid_t without_times(hid_t kind) {
    const hid_t properties = H5Pcreate(kind);
    H5Pset_obj_track_times(properties, false);
    return properties;
}

hid_t with_groups() {
    const hid_t properties = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(properties, 1);
    return properties;
}

int make_group(std::int64_t file, const char* path) {
    const Handle made(without_times(H5P_GROUP_CREATE), H5Pclose), links(with_groups(), H5Pclose);
    Handle group(H5Gcreate2(file, path, links, made, H5P_DEFAULT), H5Gclose);
    return group.shut() ? 0 : -1;
}

int write(std::int64_t file, const char* path, int type, unsigned rank, const std::uint64_t* lengths, const void* values) {
    constexpr hsize_t kChunkBytes = 1 << 20;
    constexpr unsigned kDeflate = 4;
    const hid_t number = native_type(static_cast<NumberType>(type));
    if (rank < 1 || rank > 2) return -1;
    std::array<hsize_t, 2> sizes{lengths[0], rank == 2 ? lengths[1] : 1}, chunk = sizes;
    const Handle space(H5Screate_simple(static_cast<int>(rank), sizes.data(), nullptr), H5Sclose);
    const Handle properties(without_times(H5P_DATASET_CREATE), H5Pclose), links(with_groups(), H5Pclose);
    if (sizes[0] > 0 && sizes[1] > 0) {
        chunk[0] = std::clamp<hsize_t>(kChunkBytes / (H5Tget_size(number) * sizes[1]), 1, sizes[0]);
        if (H5Pset_chunk(properties, static_cast<int>(rank), chunk.data()) < 0) return -1;
        if (H5Pset_shuffle(properties) < 0 || H5Pset_deflate(properties, kDeflate) < 0) return -1;
    }
    Handle dataset(H5Dcreate2(file, path, number, space, links, properties, H5P_DEFAULT), H5Dclose);
    if (dataset < 0 || H5Dwrite(dataset, number, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) return -1;
    return dataset.shut() ? 0 : -1;
}

int write_text(std::int64_t file, const char* object, const char* name, const char* text, std::size_t length) {
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
    if (H5Tset_size(type, length) < 0 || H5Tset_strpad(type, H5T_STR_NULLPAD) < 0) return -1;
    Handle attribute(H5Acreate_by_name(file, object, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    return attribute < 0 || H5Awrite(attribute, type, text) < 0 || !attribute.shut() ? -1 : 0;
}

int write_integers(std::int64_t file, const char* object, const char* name, const std::int64_t* values, std::size_t count) {
    const hsize_t length = count;
    const Handle space(H5Screate_simple(1, &length, nullptr), H5Sclose);
    Handle attribute(H5Acreate_by_name(file, object, name, H5T_NATIVE_INT64, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose);
    return attribute < 0 || H5Awrite(attribute, H5T_NATIVE_INT64, values) < 0 || !attribute.shut() ? -1 : 0;
}

int finish(std::int64_t file) {
    return H5Fclose(file) < 0 ? -1 : 0;
}

}  // namespace

}  // namespace subvol::detail

extern "C" {
extern const char subvol_module_version[];
const char subvol_module_version[] = SUBVOL_VERSION;

const subvol::detail::Hdf5Functions* subvol_hdf5() {
    namespace own = subvol::detail;
    // When the program ends, the library would close what a full disk has kept it from closing, and crash. All files are closed
    // where they are written, so nothing is lost. This has to come before the first other call.
    static const herr_t leaves_exit_alone = H5dont_atexit();
    static_cast<void>(leaves_exit_alone);
    static const own::Hdf5Functions functions{.open = &own::open,
                                              .close = &own::close,
                                              .each_name = &own::each_name,
                                              .shape = &own::shape,
                                              .read = &own::read,
                                              .text = &own::text,
                                              .integers = &own::integers,
                                              .reals = &own::reals,
                                              .create = &own::create,
                                              .group = &own::make_group,
                                              .write = &own::write,
                                              .write_text = &own::write_text,
                                              .write_integers = &own::write_integers,
                                              .finish = &own::finish};
    return &functions;
}
}
