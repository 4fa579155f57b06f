// Symmetric quasi-definite systems whose entries lie near the diagonal, solved by L D L^T without pivots.
//
// Algorithm: Vanderbei, Symmetric quasidefinite matrices (1995): every ordering has such a factor, so that a row can stand
// beside the variables that it ties. A system of n rows and half width w costs O(n w^2).

#pragma once

#include <algorithm>
#include <vector>

namespace kinesic::motion {

class BandedSystem {
  public:
    BandedSystem(int size, int width)
        : size_(size), width_(width), entries_(size_t(size) * (width + 1)), inverse_(size) {}

    void clear() { std::fill(entries_.begin(), entries_.end(), 0.0); }

    // Entry of a row and a column within `width` of it; only the lower half is kept.
    double& at(int row, int column) {
        if (row < column) std::swap(row, column);
        return entries_[size_t(row) * (width_ + 1) + (width_ - row + column)];
    }

    // Adds the product with a vector to another one.
    void multiply(const std::vector<double>& by, std::vector<double>& into) const {
        for (int row = 0; row < size_; ++row) {
            const double* own = line(row);
            for (int column = std::max(0, row - width_); column < row; ++column) {
                into[row] += own[column] * by[column];
                into[column] += own[column] * by[row];
            }
            into[row] += own[row] * by[row];
        }
    }

    // Multiplies rows and columns by the same scales.
    void scale(const std::vector<double>& by) {
        for (int row = 0; row < size_; ++row) {
            double* own = line(row);
            for (int column = std::max(0, row - width_); column <= row; ++column) own[column] *= by[row] * by[column];
        }
    }

    // Replaces the entries by those of L (below the diagonal) and D.
    void factorise() {
        for (int row = 0; row < size_; ++row) {
            double* own = line(row);
            const int least = std::max(0, row - width_);
            for (int column = least; column < row; ++column) {
                const double* other = line(column);
                double sum = own[column];
                for (int k = std::max(least, column - width_); k < column; ++k) sum -= own[k] * other[k];
                own[column] = sum;  // times D, until the row is done
            }
            double pivot = own[row];
            for (int column = least; column < row; ++column) {
                const double scaled = own[column];
                own[column] = scaled * inverse_[column];
                pivot -= scaled * own[column];
            }
            own[row] = pivot;
            inverse_[row] = 1.0 / pivot;
        }
    }

    // Solves in place, after `factorise`.
    void solve(std::vector<double>& right) const {
        for (int row = 0; row < size_; ++row) {
            const double* own = line(row);
            double sum = right[row];
            for (int k = std::max(0, row - width_); k < row; ++k) sum -= own[k] * right[k];
            right[row] = sum;
        }
        for (int row = 0; row < size_; ++row) right[row] *= inverse_[row];
        for (int row = size_ - 1; row >= 0; --row) {
            const double* own = line(row);
            for (int k = std::max(0, row - width_); k < row; ++k) right[k] -= own[k] * right[row];
        }
    }

    // A row, to be indexed by columns up to its own.
    double* line(int row) { return entries_.data() + size_t(row) * (width_ + 1) + width_ - row; }
    const double* line(int row) const { return entries_.data() + size_t(row) * (width_ + 1) + width_ - row; }

  private:
    int size_, width_;
    std::vector<double> entries_;  // (size, width + 1)
    std::vector<double> inverse_;  // (size,) of D
};

}  // namespace kinesic::motion
