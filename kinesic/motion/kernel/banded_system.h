// Symmetric quasi-definite systems whose entries lie near the diagonal, solved by L D L^T without pivots.
//
// Algorithm: Vanderbei, Symmetric quasidefinite matrices (1995): every ordering has such a factor, so that a row can stand
// beside the variables that it ties. L has entries only where a row of the system has begun (its envelope; Jennings, 1966),
// so that n rows of half width w cost O(n w^2), and a wider row costs no more than itself.

#pragma once

#include <algorithm>
#include <vector>

namespace kinesic::motion {

class BandedSystem {
  public:
    // Args: the column in which each row begins, up to its own.
    explicit BandedSystem(const std::vector<int>& first)
        : size_(int(first.size())), first_(first), starts_(first.size()), inverse_(first.size()) {
        int count = 0;
        for (int row = 0; row < size_; ++row) {
            starts_[row] = count - first_[row];
            count += row - first_[row] + 1;
        }
        entries_.resize(count);
    }

    void clear() { std::fill(entries_.begin(), entries_.end(), 0.0); }

    // Takes over another system of the same shape, with rows and columns multiplied by the same scales.
    void scale(const BandedSystem& other, const std::vector<double>& by) {
        for (int row = 0; row < size_; ++row) {
            const double* from = other.line(row);
            double* own = line(row);
            for (int column = first_[row]; column <= row; ++column) own[column] = from[column] * by[row] * by[column];
        }
    }

    // Adds the product with a vector to another one.
    void multiply(const std::vector<double>& by, std::vector<double>& into) const {
        const double* x = by.data();
        double* sums = into.data();
        for (int row = 0; row < size_; ++row) {
            const double* own = line(row);
            double sum = own[row] * x[row];
            each_before(row, [&](int column) {
                sum += own[column] * x[column];
                sums[column] += own[column] * x[row];
            });
            sums[row] += sum;
        }
    }

    // Replaces the entries by those of L (below the diagonal) and D.
    void factorise() {
        for (int row = 0; row < size_; ++row) {
            double* own = line(row);
            const int begin = first_[row];
            for (int column = begin + 1; column < row; ++column) {
                const double* other = line(column);
                double sum = own[column];
                for (int k = std::max(begin, first_[column]); k < column; ++k) sum -= own[k] * other[k];
                own[column] = sum;  // times D, until the row is done
            }
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

    // Solves in place, after `factorise`.
    void solve(std::vector<double>& right) const {
        double* x = right.data();
        for (int row = 0; row < size_; ++row) {
            const double* own = line(row);
            double sum = x[row];
            each_before(row, [&](int k) { sum -= own[k] * x[k]; });
            x[row] = sum;
        }
        for (int row = 0; row < size_; ++row) x[row] *= inverse_[row];
        for (int row = size_ - 1; row >= 0; --row) {
            const double* own = line(row);
            const double value = x[row];
            each_before(row, [&](int k) { x[k] -= own[k] * value; });
        }
    }

    // A row, to be indexed by columns from its first to its own.
    double* line(int row) { return entries_.data() + starts_[row]; }
    const double* line(int row) const { return entries_.data() + starts_[row]; }

  private:
    // Calls visit(column) for the columns of a row before its own; most rows have three.
    template <typename Visit>
    void each_before(int row, Visit visit) const {
        if (row - first_[row] == 3) {
            visit(row - 3);
            visit(row - 2);
            visit(row - 1);
        } else {
            for (int column = first_[row]; column < row; ++column) visit(column);
        }
    }

    int size_;
    std::vector<int> first_, starts_;  // (size,)
    std::vector<double> entries_, inverse_;  // row after row; (size,) of D
};

}  // namespace kinesic::motion
