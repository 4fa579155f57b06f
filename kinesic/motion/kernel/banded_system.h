// Solver for symmetric quasi-definite systems with banded matrices, by L D L^T without pivoting.
//
// Algorithm: Vanderbei, Symmetric quasidefinite matrices (1995): every ordering has such a factor, so that an equation can
// be placed next to its variables. L is nonzero only from the first nonzero of each row on (its envelope; Jennings, 1966),
// so that n rows of half width w cost O(n w^2), and a wider row adds only its own cost.

#pragma once

#include <algorithm>
#include <vector>

namespace kinesic::motion {

constexpr int WIDTH = 3;  // entries left of the diagonal in most rows; loops over them are unrolled

class BandedSystem {
  public:
    // Args: column of the first entry of each row; these columns must not decrease.
    explicit BandedSystem(const std::vector<int>& first)
        : size_(int(first.size())), first_(first), starts_(first.size()), inverse_(first.size()) {
        int count = 0;
        for (int row = 0; row < size_; ++row) {
            starts_[row] = count - first_[row];
            count += row - first_[row] + 1;
        }
        entries_.resize(count);
        for (int row = 0, last = 0; row < size_; ++row) {
            while (last + 1 < size_ && first_[last + 1] <= row) ++last;
            last_.push_back(last);
        }
    }

    void clear() { std::fill(entries_.begin(), entries_.end(), 0.0); }

    // Copies another system of the same shape, with rows and columns multiplied by the same scales.
    void scale(const BandedSystem& other, const std::vector<double>& by) {
        for (int row = 0; row < size_; ++row) {
            const double* from = other.line(row);
            double* own = line(row);
            for (int column = first_[row]; column <= row; ++column) own[column] = from[column] * by[row] * by[column];
        }
    }

    // Computes the product with a vector.
    void multiply(const std::vector<double>& by, std::vector<double>& into) const {
        const double* x = by.data();
        for (int row = 0; row < size_; ++row) {
            const double* own = line(row);
            double sum = own[row] * x[row];
            if (row - first_[row] == WIDTH) {
                sum += own[row - 3] * x[row - 3];
                sum += own[row - 2] * x[row - 2];
                sum += own[row - 1] * x[row - 1];
            } else {
                for (int column = first_[row]; column < row; ++column) sum += own[column] * x[column];
            }
            if (last_[row] - row == WIDTH) {
                sum += line(row + 1)[row] * x[row + 1];
                sum += line(row + 2)[row] * x[row + 2];
                sum += line(row + 3)[row] * x[row + 3];
            } else {
                for (int below = row + 1; below <= last_[row]; ++below) sum += line(below)[row] * x[below];
            }
            into[row] = sum;
        }
    }

    // Replaces the entries by those of L (below the diagonal) and D.
    void factorise() {
        for (int row = 0; row < size_; ++row) {
            double* own = line(row);
            eliminate(row);
            double pivot = own[row];
            each_before(row, [&](int column) {
                const double scaled = own[column];
                own[column] = scaled * inverse_[column];
                pivot -= scaled * own[column];
            });
            own[row] = pivot;
            inverse_[row] = 1.0 / pivot;
        }
    }

    // Solves in place, after `factorise`. The last three values stay in registers, as each row depends on the one before.
    void solve(std::vector<double>& right) const {
        double* x = right.data();
        double third = 0.0, second = 0.0, next = 0.0;
        for (int row = 0; row < size_; ++row) {
            const double* own = line(row);
            double sum = x[row];
            if (row - first_[row] == WIDTH)
                sum = sum - own[row - 3] * third - own[row - 2] * second - own[row - 1] * next;
            else
                for (int k = first_[row]; k < row; ++k) sum -= own[k] * x[k];
            third = second, second = next, next = x[row] = sum;
        }
        for (int row = 0; row < size_; ++row) x[row] *= inverse_[row];
        for (int row = size_ - 1; row >= 0; --row) {
            double sum = x[row];
            if (last_[row] - row == WIDTH)
                sum = sum - line(row + 3)[row] * third - line(row + 2)[row] * second - line(row + 1)[row] * next;
            else
                for (int below = last_[row]; below > row; --below) sum -= line(below)[row] * x[below];
            third = second, second = next, next = x[row] = sum;
        }
    }

    // Returns a row, indexed by columns from its first entry to the diagonal.
    double* line(int row) { return entries_.data() + starts_[row]; }
    const double* line(int row) const { return entries_.data() + starts_[row]; }

  private:
    // Replaces the entries left of a row's diagonal by those of L times D.
    void eliminate(int row) {
        double* own = line(row);
        const int begin = first_[row];
        if (row - begin == WIDTH) {
            const double *above = line(row - 1), *second = line(row - 2);
            own[row - 2] -= own[row - 3] * second[row - 3];
            own[row - 1] = own[row - 1] - own[row - 3] * above[row - 3] - own[row - 2] * above[row - 2];
            return;
        }
        for (int column = begin + 1; column < row; ++column) {
            const double* other = line(column);
            double sum = own[column];
            for (int k = std::max(begin, first_[column]); k < column; ++k) sum -= own[k] * other[k];
            own[column] = sum;
        }
    }

    // Calls visit(column) for the columns left of a row's diagonal; most rows have three.
    template <typename Visit>
    void each_before(int row, Visit visit) const {
        if (row - first_[row] == WIDTH) {
            visit(row - 3);
            visit(row - 2);
            visit(row - 1);
        } else {
            for (int column = first_[row]; column < row; ++column) visit(column);
        }
    }

    int size_;
    std::vector<int> first_;  // (size,) column of each row's first entry
    std::vector<int> starts_;  // (size,) position of a row's entries, minus that column
    std::vector<int> last_;  // (size,) last row with an entry in each column
    std::vector<double> entries_, inverse_;  // entries row by row; (size,) inverse of D
};

}  // namespace kinesic::motion
