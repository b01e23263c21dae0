// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace subvol::test {

/// Writes an HDF5 file: datasets at paths, whose groups are made as they are needed.
class Hdf5Writer {
public:
    explicit Hdf5Writer(const std::filesystem::path& path)
        : file_(checked(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT))),
          groups_(H5Pcreate(H5P_LINK_CREATE)) {
        H5Pset_create_intermediate_group(groups_, 1);
    }
    ~Hdf5Writer() {
        H5Pclose(groups_);
        H5Fclose(file_);
    }
    Hdf5Writer(const Hdf5Writer&) = delete;
    Hdf5Writer& operator=(const Hdf5Writer&) = delete;

    void group(const std::string& path) {
        H5Gclose(checked(H5Gcreate2(file_, path.c_str(), groups_, H5P_DEFAULT, H5P_DEFAULT)));
    }

    /// lengths: of the dimensions; none: one for the values. deflated: in chunks of all values; grows: along the first
    /// dimension
    template <class T>
    void put(const std::string& path, const std::vector<T>& values, std::vector<hsize_t> lengths = {}, bool deflated = false,
             bool grows = false) {
        if (lengths.empty()) lengths = {values.size()};
        std::vector<hsize_t> longest = lengths;
        if (grows) longest[0] = H5S_UNLIMITED;
        const hid_t space = H5Screate_simple(static_cast<int>(lengths.size()), lengths.data(), longest.data());
        const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
        if (deflated || grows) H5Pset_chunk(properties, static_cast<int>(lengths.size()), lengths.data());
        if (deflated) H5Pset_deflate(properties, 6);
        const hid_t set = checked(H5Dcreate2(file_, path.c_str(), type_of<T>(), space, groups_, properties, H5P_DEFAULT));
        if (!values.empty()) checked(H5Dwrite(set, type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
        H5Dclose(set);
        H5Pclose(properties);
        H5Sclose(space);
    }

    /// Floats of which none is written.
    void put_empty(const std::string& path, hsize_t length, bool grows) {
        const hsize_t longest = grows ? H5S_UNLIMITED : length, chunk = 1;
        const hid_t space = H5Screate_simple(1, &length, &longest);
        const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
        if (grows) H5Pset_chunk(properties, 1, &chunk);
        H5Dclose(checked(H5Dcreate2(file_, path.c_str(), H5T_IEEE_F32BE, space, groups_, properties, H5P_DEFAULT)));
        H5Pclose(properties);
        H5Sclose(space);
    }

    /// Doubles in one chunk, whose compressed bytes are given.
    void put_packed(const std::string& path, const std::vector<hsize_t>& lengths, const std::vector<hsize_t>& chunk,
                    const std::string& packed) {
        const std::vector<hsize_t> most(lengths.size(), H5S_UNLIMITED), first(lengths.size(), 0);
        const hid_t space = H5Screate_simple(static_cast<int>(lengths.size()), lengths.data(), most.data());
        const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
        H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
        H5Pset_deflate(properties, 6);
        const hid_t set = checked(H5Dcreate2(file_, path.c_str(), H5T_NATIVE_DOUBLE, space, groups_, properties, H5P_DEFAULT));
        checked(H5Dwrite_chunk(set, H5P_DEFAULT, 0, first.data(), packed.size(), packed.data()));
        H5Dclose(set);
        H5Pclose(properties);
        H5Sclose(space);
    }

    /// Another name of an object.
    void link(const std::string& object, const std::string& name) {
        checked(H5Lcreate_hard(file_, object.c_str(), file_, name.c_str(), groups_, H5P_DEFAULT));
    }

    void attribute(const std::string& object, const std::string& name, const std::vector<std::int64_t>& values) {
        const hsize_t count = values.size();
        const hid_t space = H5Screate_simple(1, &count, nullptr);
        write(object, name, H5T_NATIVE_INT64, space, values.data());
    }
    void reals(const std::string& object, const std::string& name, const std::vector<double>& values) {
        const hsize_t count = values.size();
        write(object, name, H5T_NATIVE_DOUBLE, H5Screate_simple(1, &count, nullptr), values.data());
    }
    void attribute(const std::string& object, const std::string& name, const std::string& text) {
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, text.size());
        write(object, name, type, H5Screate(H5S_SCALAR), text.data());
        H5Tclose(type);
    }

private:
    template <class Result>
    static Result checked(Result result) {
        if (result < 0) throw std::runtime_error("HDF5 failed");
        return result;
    }
    template <class T>
    static hid_t type_of() {
        if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
        if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
        if constexpr (std::is_same_v<T, char>) return H5T_C_S1;
        if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
        if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
        return H5T_NATIVE_INT64;
    }
    void write(const std::string& object, const std::string& name, hid_t type, hid_t space, const void* values) {
        const hid_t attribute =
            checked(H5Acreate_by_name(file_, object.c_str(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
        checked(H5Awrite(attribute, type, values));
        H5Aclose(attribute);
        H5Sclose(space);
    }

    hid_t file_, groups_;
};

}  // namespace subvol::test
