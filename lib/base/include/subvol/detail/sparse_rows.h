// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "subvol/detail/add_times.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/index.h"

namespace subvol::detail {

/// A sparse matrix in compressed rows: row r has columns[offsets[r] .. offsets[r+1]), with their weights beside them. The calls
/// below take any struct with these three members, such as CsrMatrix.
template <class Weight, class Column = Index, class Offset = std::size_t>
struct SparseRows {
    std::vector<Offset> offsets{0};
    std::vector<Column> columns;
    std::vector<Weight> weights;
};

template <class Matrix>
[[nodiscard]] std::size_t row_count(const Matrix& matrix) {
    return matrix.offsets.size() - 1;
}

/// The product of a row with values: numbers, vectors, or arrays of numbers.
template <class Matrix, class Values>
[[nodiscard]] auto row_times(const Matrix& matrix, std::size_t row, const Values& values) {
    typename Values::value_type sum{};
    for (std::size_t k = matrix.offsets[row]; k < matrix.offsets[row + 1]; ++k) {
        add_times(sum, matrix.weights[k], values[matrix.columns[k]]);
    }
    return sum;
}

/// The products of all rows with values. cost: parallel; bitwise the same for any number of threads
template <class Matrix, class Values, class Products>
void multiply(const Matrix& matrix, const Values& values, Products& products) {
    products.resize(row_count(matrix));
    parallel_each(products.size(), [&](std::size_t row) { products[row] = row_times(matrix, row, values); });
}

template <class Matrix, class Values>
[[nodiscard]] auto product_with(const Matrix& matrix, const Values& values) {
    std::vector<typename Values::value_type> products;
    multiply(matrix, values, products);
    return products;
}

/// columns: how many the matrix has
/// returns: the transpose; columns of its rows ascend
template <class Matrix>
[[nodiscard]] Matrix transpose_of(const Matrix& matrix, std::size_t columns) {
    Matrix made;
    made.offsets.assign(columns + 1, 0);
    for (const auto column : matrix.columns) ++made.offsets[column + std::size_t{1}];
    for (std::size_t c = 0; c < columns; ++c) made.offsets[c + 1] += made.offsets[c];
    made.columns.resize(matrix.columns.size());
    made.weights.resize(matrix.columns.size());
    auto next = made.offsets;
    for (std::size_t row = 0; row < row_count(matrix); ++row) {
        for (std::size_t k = matrix.offsets[row]; k < matrix.offsets[row + 1]; ++k) {
            const std::size_t at = next[matrix.columns[k]]++;
            made.columns[at] = static_cast<typename decltype(made.columns)::value_type>(row);
            made.weights[at] = matrix.weights[k];
        }
    }
    return made;
}

/// The rows of several matrices, one after the other.
template <class Matrix>
[[nodiscard]] Matrix joined_rows(std::vector<Matrix> parts) {
    Matrix made;
    std::size_t rows = 0, terms = 0;
    for (const Matrix& part : parts) rows += row_count(part), terms += part.columns.size();
    made.offsets.reserve(rows + 1);
    made.columns.reserve(terms);
    made.weights.reserve(terms);
    for (Matrix& part : parts) {
        const auto before = made.offsets.back();
        for (std::size_t row = 1; row < part.offsets.size(); ++row) made.offsets.push_back(before + part.offsets[row]);
        made.columns.insert(made.columns.end(), part.columns.begin(), part.columns.end());
        made.weights.insert(made.weights.end(), part.weights.begin(), part.weights.end());
        part = {};
    }
    return made;
}

}  // namespace subvol::detail
