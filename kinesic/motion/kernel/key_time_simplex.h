// Smallest shifts of key times t from the requested times a, by the simplex method on the dual program.
//
//   primal  least    sum late_k (t_k - a_k)+ + early_k (a_k - t_k)+ + sum penalty_r (c_r t - d_r)+
//           penalty_r: infinite for a row that must hold
//   dual    largest  sum y_r (c_r a - d_r)   with  0 <= y_r <= penalty_r,  -late <= z = C' y <= early
//
// The method starts with y = 0 nonbasic and z basic, which corresponds to the requested times. The reduced cost of y_r is
// c_r t - d_r, the violation of a row; that of z_k is a_k - t_k (Dantzig, Linear programming and extensions,
// 1963, chapter 18: bounded variables; dictionary, entering and leaving as in Chvatal, Linear programming, 1983).

#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace kinesic::motion {

constexpr double OPTIMALITY_TOLERANCE = 1e-9;  // [s], or the unit of a plane: reduced costs up to this count as optimal
constexpr double MIN_PIVOT = 1e-9;  // smallest accepted divisor
constexpr int MAX_ITERATION_RATIO = 20;  // iterations per row and key after which the method gives up
constexpr int LARGEST_COST_ITERATIONS = 3;  // multiple of rows and keys after which Bland's rule (1977) avoids cycles

class KeyTimeSimplex {
  public:
    // Args: coefficients (rows, keys) of the times in each row, violations at the requested times, and the weights above.
    KeyTimeSimplex(int keys, int rows, const double* shares, const double* broken, const double* late, const double* early,
                   const double* penalties)
        : keys_(keys), rows_(rows), dictionary_(size_t(keys) * rows), reduced_costs_(broken, broken + rows),
          basic_values_(keys, 0.0), basic_(keys), nonbasic_(rows), lower_(rows + keys, 0.0),
          upper_(penalties, penalties + rows), at_upper_(rows + keys, false) {
        upper_.insert(upper_.end(), early, early + keys);
        for (int k = 0; k < keys; ++k) {
            lower_[rows + k] = -late[k];
            basic_[k] = rows + k;
            for (int r = 0; r < rows; ++r) entry(k, r) = shares[size_t(r) * keys + k];
        }
        for (int r = 0; r < rows; ++r) nonbasic_[r] = r;
    }

    // Runs the method and returns whether an optimum exists; without feasible times the dual program is unbounded.
    bool solve() {
        const int size = keys_ + rows_;
        for (int iteration = 0; iteration < MAX_ITERATION_RATIO * size; ++iteration) {
            const int column = choose_entering(iteration > LARGEST_COST_ITERATIONS * size);
            if (column < 0) return true;
            if (!enter(column)) return false;
        }
        return false;
    }

    // Returns the shift of each time, (keys,) [s].
    std::vector<double> moves() const {
        std::vector<double> found(keys_, 0.0);
        for (int r = 0; r < rows_; ++r)
            if (nonbasic_[r] >= rows_) found[nonbasic_[r] - rows_] = -reduced_costs_[r];
        return found;
    }

  private:
    double& entry(int row, int column) { return dictionary_[size_t(row) * rows_ + column]; }

    // Returns the column of the entering variable, by largest cost or by smallest index; -1: none.
    int choose_entering(bool by_index) const {
        int entering = -1;
        double largest = OPTIMALITY_TOLERANCE;
        for (int r = 0; r < rows_; ++r) {
            const int variable = nonbasic_[r];
            const double cost = at_upper_[variable] ? -reduced_costs_[r] : reduced_costs_[r];
            if (cost <= (by_index ? OPTIMALITY_TOLERANCE : largest) || lower_[variable] == upper_[variable]) continue;
            if (by_index && entering >= 0 && variable > nonbasic_[entering]) continue;
            entering = r;
            largest = cost;
        }
        return entering;
    }

    // Moves the variable of a column off its bound until a variable reaches a bound; false if none ever does.
    bool enter(int column) {
        const int entering = nonbasic_[column];
        const double direction = at_upper_[entering] ? -1.0 : 1.0;
        double step = upper_[entering] - lower_[entering];
        const int leaving_row = run_ratio_test(column, direction, step);
        if (!std::isfinite(step)) return false;
        for (int k = 0; k < keys_; ++k) basic_values_[k] += step * direction * entry(k, column);
        if (leaving_row < 0) {
            at_upper_[entering] = !at_upper_[entering];
            return true;
        }
        pivot(leaving_row, column, direction, step);
        return true;
    }

    // Returns the row of the leaving variable and the step; -1: none before the entering variable's other bound.
    int run_ratio_test(int column, double direction, double& step) {
        int leaving_row = -1;
        double largest = 0.0;  // pivot among equal ratios
        for (int k = 0; k < keys_; ++k) {
            const double rate = direction * entry(k, column);
            if (std::abs(rate) < MIN_PIVOT) continue;
            const int variable = basic_[k];
            const double slack = rate > 0.0 ? upper_[variable] - basic_values_[k] : basic_values_[k] - lower_[variable];
            const double ratio = std::max(slack, 0.0) / std::abs(rate);
            if (ratio > step || (ratio == step && std::abs(rate) <= largest)) continue;
            step = ratio;
            largest = std::abs(rate);
            leaving_row = k;
        }
        return leaving_row;
    }

    // Lets the variable of a column enter the basis, and that of a row leave it at the bound that it reached.
    void pivot(int row, int column, double direction, double step) {
        const int entering = nonbasic_[column], leaving = basic_[row];
        at_upper_[leaving] = direction * entry(row, column) > 0.0;
        basic_values_[row] = (at_upper_[entering] ? upper_[entering] : lower_[entering]) + direction * step;
        basic_[row] = entering;
        nonbasic_[column] = leaving;
        const double inverse = 1.0 / entry(row, column);
        double* pivot_row = &entry(row, 0);
        for (int r = 0; r < rows_; ++r) pivot_row[r] *= -inverse;
        pivot_row[column] = inverse;
        for (int k = 0; k < keys_; ++k)
            if (k != row) substitute(&entry(k, 0), pivot_row, column);
        substitute(reduced_costs_.data(), pivot_row, column);
    }

    // Substitutes the pivot row for the entering variable in a row of the dictionary.
    void substitute(double* row, const double* pivot_row, int column) const {
        const double factor = row[column];
        if (factor == 0.0) return;
        row[column] = 0.0;
        for (int r = 0; r < rows_; ++r) row[r] += factor * pivot_row[r];
    }

    const int keys_, rows_;
    std::vector<double> dictionary_;  // (keys, rows) basic variables by nonbasic ones
    std::vector<double> reduced_costs_, basic_values_;  // (rows,) of the nonbasic, (keys,) of the basic variables
    std::vector<int> basic_, nonbasic_;  // variables of the dictionary's rows and columns: y first, then z
    std::vector<double> lower_, upper_;  // (rows + keys,) bounds of all variables
    std::vector<bool> at_upper_;  // whether a nonbasic variable is at its upper bound
};

}  // namespace kinesic::motion
