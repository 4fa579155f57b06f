// Moves key times t away from the asked ones a as little as needed: the simplex method on the dual program.
//
//   least  sum late_k (t_k - a_k)+ + early_k (a_k - t_k)+ + sum most_r (c_r t - d_r)+
//          most_r: endless where a row has to be kept
//   dual   largest  sum y_r (c_r a - d_r)   with  0 <= y_r <= most_r,  -late <= z = C' y <= early
//
// It begins with y = 0, which stands for the asked times, and lets in what they break most; a key is moved where z_k comes to a
// bound. The slope of the sum over z_k is a_k - t_k, over y_r it is c_r t - d_r (Dantzig, Linear programming and extensions,
// 1963, chapter 18: bounded variables).

#pragma once

#include <cmath>
#include <vector>

namespace kinesic::motion {

constexpr double BROKEN_BY = 1e-9;  // [s], or of a plane's amount, by which a row counts as broken
constexpr double PIVOT = 1e-9;  // least entry that is divided by
constexpr int TURNS = 20;  // exchanges for each row and key, after which nothing is found
constexpr int PLAIN = 3;  // of them, after which the first variable comes in instead of the best: circles are rarer so

class KeyTimeSimplex {
  public:
    // Args: shares (rows, keys) of the times in each row, by how much the asked times break it, and the weights above.
    KeyTimeSimplex(int keys, int rows, const double* shares, const double* broken, const double* late, const double* early,
                   const double* most)
        : keys_(keys), rows_(rows), entries_(size_t(keys) * rows), slopes_(broken, broken + rows), values_(keys, 0.0),
          inside_(keys), outside_(rows), lower_(rows + keys, 0.0), upper_(most, most + rows), at_upper_(rows + keys, false) {
        upper_.insert(upper_.end(), early, early + keys);
        for (int k = 0; k < keys; ++k) {
            lower_[rows + k] = -late[k];
            inside_[k] = rows + k;
            for (int r = 0; r < rows; ++r) entry(k, r) = shares[size_t(r) * keys + k];
        }
        for (int r = 0; r < rows; ++r) outside_[r] = r;
    }

    // Whether an optimum is found; there is none where no times keep all rows.
    bool solve() {
        const int size = keys_ + rows_;
        for (int turn = 0; turn < TURNS * size; ++turn) {
            const int column = choose(turn > PLAIN * size);
            if (column < 0) return true;
            if (!bring_in(column)) return false;
        }
        return false;
    }

    // (keys,) [s] by which each time is moved.
    std::vector<double> moves() const {
        std::vector<double> found(keys_, 0.0);
        for (int r = 0; r < rows_; ++r)
            if (outside_[r] >= rows_) found[outside_[r] - rows_] = -slopes_[r];
        return found;
    }

  private:
    double& entry(int row, int column) { return entries_[size_t(row) * rows_ + column]; }

    // The variable at a bound that is worth most away from it; -1: none is.
    int choose(bool plain) const {
        int best = -1;
        double most = BROKEN_BY;
        for (int r = 0; r < rows_; ++r) {
            const int variable = outside_[r];
            const double worth = at_upper_[variable] ? -slopes_[r] : slopes_[r];
            if (worth <= (plain ? BROKEN_BY : most) || lower_[variable] == upper_[variable]) continue;
            if (plain && best >= 0 && variable > outside_[best]) continue;
            best = r;
            most = worth;
        }
        return best;
    }

    // Moves a variable off its bound until another one comes to its own; false where none ever does.
    bool bring_in(int column) {
        const int variable = outside_[column];
        const double way = at_upper_[variable] ? -1.0 : 1.0;
        double step = upper_[variable] - lower_[variable], pivot = 0.0;
        int leaving = -1;
        for (int k = 0; k < keys_; ++k) {
            const double rate = way * entry(k, column);
            if (std::abs(rate) < PIVOT) continue;
            const double room = rate > 0.0 ? upper_[inside_[k]] - values_[k] : values_[k] - lower_[inside_[k]];
            const double reach = std::max(room, 0.0) / std::abs(rate);
            if (reach > step || (reach == step && std::abs(rate) <= pivot)) continue;
            step = reach;
            pivot = std::abs(rate);
            leaving = k;
        }
        if (!std::isfinite(step)) return false;
        for (int k = 0; k < keys_; ++k) values_[k] += step * way * entry(k, column);
        if (leaving < 0) {
            at_upper_[variable] = !at_upper_[variable];
            return true;
        }
        exchange(leaving, column, way, step);
        return true;
    }

    // Lets the variable of a column in, and that of a row out, at the bound to which it has come.
    void exchange(int row, int column, double way, double step) {
        const int in = outside_[column], out = inside_[row];
        at_upper_[out] = way * entry(row, column) > 0.0;
        values_[row] = (at_upper_[in] ? upper_[in] : lower_[in]) + way * step;
        inside_[row] = in;
        outside_[column] = out;
        const double inverse = 1.0 / entry(row, column);
        double* own = &entry(row, 0);
        for (int r = 0; r < rows_; ++r) own[r] *= -inverse;
        own[column] = inverse;
        for (int k = 0; k < keys_; ++k)
            if (k != row) add(&entry(k, 0), own, column);
        add(slopes_.data(), own, column);
    }

    // Replaces the variable of a column in a line by the row in which it stands now.
    void add(double* line, const double* own, int column) const {
        const double share = line[column];
        if (share == 0.0) return;
        line[column] = 0.0;
        for (int r = 0; r < rows_; ++r) line[r] += share * own[r];
    }

    const int keys_, rows_;
    std::vector<double> entries_, slopes_, values_;  // (keys, rows), (rows,) of the sum, (keys,)
    std::vector<int> inside_, outside_;  // variables of lines and columns: rows first, then keys
    std::vector<double> lower_, upper_;  // (rows + keys,)
    std::vector<bool> at_upper_;
};

}  // namespace kinesic::motion
