// Distances between capsules in many postures, for `sim/distances.py`.

#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace kinesic::sim {

inline double clamped_ratio(double part, double whole) {
    return whole > std::numeric_limits<double>::min() ? std::min(std::max(part / whole, 0.0), 1.0) : 0.0;
}

inline double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Distance between two line segments, each a point and a vector (Ericson, Real-Time Collision Detection, 5.1.9).
inline double segment_distance(const double* a, const double* along_a, const double* b, const double* along_b) {
    const double apart[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    const double aa = dot(along_a, along_a), bb = dot(along_b, along_b), ab = dot(along_a, along_b);
    const double ar = dot(along_a, apart), br = dot(along_b, apart);
    // Nearest parameter on infinite lines, arbitrary if they are parallel.
    double s = clamped_ratio(ab * br - ar * bb, aa * bb - ab * ab);
    const double t = clamped_ratio(ab * s + br, bb);
    s = clamped_ratio(ab * t - ar, aa);
    double gap[3];
    for (int i = 0; i < 3; ++i) gap[i] = apart[i] + s * along_a[i] - t * along_b[i];
    return std::sqrt(dot(gap, gap));
}

constexpr int STRIP = 64;  // postures processed together, so that their data fit into the L1 cache

// Segment frames of several postures: rotations (s, 3, 3, stride) and origins (s, 3, stride).
struct Frames {
    const double *rotations, *origins;
    size_t stride;
};

struct CapsulePairs {
    int capsules = 0, pairs = 0;
    std::vector<int> owners;            // (c,) segment of each capsule
    std::vector<double> starts, ends;   // (c, 3) [m] axis ends in the segment's frame
    std::vector<int> first, second;     // (p,) capsule indices of each pair
    std::vector<double> radii, halves;  // (p,) [m] sums of the radii and of the half lengths of a pair
    std::vector<char> hulled;           // (p,) whether a pair contains a finger ball, whose distance is no upper bound

    // Computes distances (p, stride) [m] in at most STRIP postures, but only lower bounds for pairs that cannot be closest.
    void closest(const Frames& frames, int count, double* lowest, size_t stride) {
        axes.resize(6 * STRIP * size_t(capsules));
        double bound[STRIP];
        std::fill_n(bound, STRIP, std::numeric_limits<double>::infinity());
        for (int c = 0; c < capsules; ++c) place(c, frames, count);
        for (int p = 0; p < pairs; ++p) {
            double* row = lowest + p * stride;
            midpoint_distances(p, count, row);
            if (!hulled[p])
                for (int m = 0; m < count; ++m) bound[m] = std::min(bound[m], row[m]);
        }
        for (int p = 0; p < pairs; ++p) {
            double* row = lowest + p * stride;
            bool near = false;
            for (int m = 0; m < count; ++m) {
                row[m] -= halves[p];
                near |= row[m] <= bound[m];
            }
            for (int m = 0; near && m < count; ++m)
                if (row[m] <= bound[m]) row[m] = exact(p, m) - radii[p];
        }
    }

    // Computes the distances (p, stride) [m] of all pairs in at most STRIP postures.
    void gaps(const Frames& frames, int count, double* found, size_t stride) {
        axes.resize(6 * STRIP * size_t(capsules));
        for (int c = 0; c < capsules; ++c) place(c, frames, count);
        for (int p = 0; p < pairs; ++p)
            for (int m = 0; m < count; ++m) found[p * stride + m] = exact(p, m) - radii[p];
    }

private:
    std::vector<double> axes;  // (c, 2, 3, STRIP) [m] start of each capsule's axis, and the vector to its end

    double* from(int capsule) { return &axes[6 * STRIP * size_t(capsule)]; }
    double* along(int capsule) { return from(capsule) + 3 * STRIP; }

    void place(int capsule, const Frames& frames, int count) {
        const double* rotation = frames.rotations + 9 * size_t(owners[capsule]) * frames.stride;
        const double* origin = frames.origins + 3 * size_t(owners[capsule]) * frames.stride;
        const double *a = &starts[3 * capsule], *b = &ends[3 * capsule];
        for (int i = 0; i < 3; ++i) {
            const double *x = rotation + 3 * i * frames.stride, *y = x + frames.stride, *z = y + frames.stride;
            const double* at = origin + i * frames.stride;
            double *begin = from(capsule) + i * STRIP, *vector = along(capsule) + i * STRIP;
            for (int m = 0; m < count; ++m) {
                begin[m] = at[m] + (a[0] * x[m] + a[1] * y[m] + a[2] * z[m]);
                vector[m] = at[m] + (b[0] * x[m] + b[1] * y[m] + b[2] * z[m]) - begin[m];
            }
        }
    }

    // Computes the distances of the axes' midpoints: upper bounds, and after subtracting half lengths lower bounds.
    void midpoint_distances(int pair, int count, double* above) {
        const double *a = from(first[pair]), *b = from(second[pair]), *u = along(first[pair]), *v = along(second[pair]);
        for (int m = 0; m < count; ++m) {
            double squares = 0.0;
            for (int k = 0; k < 3; ++k) {
                const int at = k * STRIP + m;
                const double between = (a[at] + u[at] / 2) - (b[at] + v[at] / 2);
                squares += between * between;
            }
            above[m] = std::sqrt(squares) - radii[pair];
        }
    }

    double exact(int pair, int m) {
        double ends[4][3];
        const double* rows[4] = {from(first[pair]), along(first[pair]), from(second[pair]), along(second[pair])};
        for (int e = 0; e < 4; ++e)
            for (int k = 0; k < 3; ++k) ends[e][k] = rows[e][k * STRIP + m];
        return segment_distance(ends[0], ends[1], ends[2], ends[3]);
    }
};

// Bodies that consist of one or, like fingers, several capsules.
struct Bodies {
    std::vector<int> begins;    // (b + 1,) first capsule of each body
    std::vector<double> radii;  // (c,) [m] radius of each capsule
    // Axis ends of all capsules in several postures, (c, 3, count) [m].
    const double *starts, *ends;
    size_t count;

    // Returns the distance [m] of two bodies in a posture.
    double apart(int first, int second, size_t posture) const {
        double nearest = std::numeric_limits<double>::infinity();
        for (int i = begins[first]; i < begins[first + 1]; ++i) {
            double a[3], along_a[3];
            place(i, posture, a, along_a);
            for (int j = begins[second]; j < begins[second + 1]; ++j) {
                double b[3], along_b[3];
                place(j, posture, b, along_b);
                nearest = std::min(nearest, segment_distance(a, along_a, b, along_b) - (radii[i] + radii[j]));
            }
        }
        return nearest;
    }

private:
    void place(int capsule, size_t posture, double* from, double* along) const {
        for (int k = 0; k < 3; ++k) {
            const size_t at = (3 * size_t(capsule) + k) * count + posture;
            from[k] = starts[at];
            along[k] = ends[at] - starts[at];
        }
    }
};

// Measured posture with the distances (p,) [m] of all pairs.
struct Neighbour {
    const double* angles = nullptr;  // (n,) [rad]
    std::vector<double> lowest;      // (p,) [m]
    double least = 0.0;              // [m] smallest distance
};

// Bound on the distances in unmeasured postures: a pair approaches at most by its reach times the hinge rotations from a
// measured posture.
struct Reaches {
    int hinges = 0, pairs = 0;
    const double* of_pairs = nullptr;  // (p, n) [m/rad] largest approach of each pair per angle of each hinge
    std::vector<double> farthest;      // (n,) [m/rad] largest reach of any pair
    std::vector<double> turned[2];     // (n,) [rad] hinge rotations from both neighbours

    // Returns whether any pair may be closer than a limit [m], judged from both neighbours.
    bool may_be_near(const double* now, const Neighbour* const (&neighbours)[2], double limit) {
        double most[2] = {};
        for (int k = 0; k < 2; ++k) {
            turned[k].resize(hinges);
            for (int i = 0; i < hinges; ++i) {
                turned[k][i] = std::abs(now[i] - neighbours[k]->angles[i]);
                most[k] += turned[k][i] * farthest[i];
            }
            if (neighbours[k]->least - most[k] >= limit) return false;
        }
        for (int p = 0; p < pairs; ++p) {
            bool near = true;
            for (int k = 0; near && k < 2; ++k) near = neighbours[k]->lowest[p] - most[k] < limit;
            for (int k = 0; near && k < 2; ++k) {
                double nearer = 0.0;
                for (int i = 0; i < hinges; ++i) nearer += turned[k][i] * of_pairs[p * hinges + i];
                near = neighbours[k]->lowest[p] - nearer < limit;
            }
            if (near) return true;
        }
        return false;
    }
};

}  // namespace kinesic::sim
