// Distances between capsules in many postures: `sim/distances.py`, compiled.

#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace kinesic::sim {

inline double share(double part, double whole) {
    return whole > std::numeric_limits<double>::min() ? std::min(std::max(part / whole, 0.0), 1.0) : 0.0;
}

inline double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Between two straight segments, each from a point along a vector: Ericson, Real-Time Collision Detection, 5.1.9.
inline double segment_distance(const double* a, const double* along_a, const double* b, const double* along_b) {
    const double apart[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    const double aa = dot(along_a, along_a), bb = dot(along_b, along_b), ab = dot(along_a, along_b);
    const double ar = dot(along_a, apart), br = dot(along_b, apart);
    double s = share(ab * br - ar * bb, aa * bb - ab * ab);  // of the unbounded lines; any s serves parallel ones
    const double t = share(ab * s + br, bb);
    s = share(ab * t - ar, aa);
    double gap[3];
    for (int i = 0; i < 3; ++i) gap[i] = apart[i] + s * along_a[i] - t * along_b[i];
    return std::sqrt(dot(gap, gap));
}

constexpr int STRIP = 64;  // postures at once, so that everything about them stays in the nearest cache

// Rotations (s, 3, 3, stride) and origins (s, 3, stride) of some postures.
struct Frames {
    const double *rotations, *origins;
    size_t stride;
};

struct CapsulePairs {
    int capsules = 0, pairs = 0;
    std::vector<int> owners;            // (c,) segments
    std::vector<double> starts, ends;   // (c, 3) [m] in them
    std::vector<int> first, second;     // (p,) capsules
    std::vector<double> radii, halves;  // (p,) [m] sums of radii and of half lengths
    std::vector<char> hulled;           // (p,) whether a ball about fingers takes part: it bounds nothing from above

    // Distance [m] of each pair in at most STRIP postures, (p, stride); for those that cannot be the closest, a bound.
    void closest(const Frames& frames, int count, double* lowest, size_t stride) {
        axes.resize(6 * STRIP * size_t(capsules));
        double bound[STRIP];
        std::fill_n(bound, STRIP, std::numeric_limits<double>::infinity());
        for (int c = 0; c < capsules; ++c) place(c, frames, count);
        for (int p = 0; p < pairs; ++p) {
            double* row = lowest + p * stride;
            middles(p, count, row);
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

    // Distance [m] of each pair in at most STRIP postures, (p, stride).
    void gaps(const Frames& frames, int count, double* found, size_t stride) {
        axes.resize(6 * STRIP * size_t(capsules));
        for (int c = 0; c < capsules; ++c) place(c, frames, count);
        for (int p = 0; p < pairs; ++p)
            for (int m = 0; m < count; ++m) found[p * stride + m] = exact(p, m) - radii[p];
    }

private:
    std::vector<double> axes;  // (c, 2, 3, STRIP) [m] one end of each capsule's axis, and the way to the other

    double* from(int capsule) { return &axes[6 * STRIP * size_t(capsule)]; }
    double* along(int capsule) { return from(capsule) + 3 * STRIP; }

    void place(int capsule, const Frames& frames, int count) {
        const double* rotation = frames.rotations + 9 * size_t(owners[capsule]) * frames.stride;
        const double* origin = frames.origins + 3 * size_t(owners[capsule]) * frames.stride;
        const double *a = &starts[3 * capsule], *b = &ends[3 * capsule];
        for (int i = 0; i < 3; ++i) {
            const double *x = rotation + 3 * i * frames.stride, *y = x + frames.stride, *z = y + frames.stride;
            const double* at = origin + i * frames.stride;
            double *begin = from(capsule) + i * STRIP, *way = along(capsule) + i * STRIP;
            for (int m = 0; m < count; ++m) {
                begin[m] = at[m] + (a[0] * x[m] + a[1] * y[m] + a[2] * z[m]);
                way[m] = at[m] + (b[0] * x[m] + b[1] * y[m] + b[2] * z[m]) - begin[m];
            }
        }
    }

    // The axes' middles bound the distance from above, less their half lengths from below.
    void middles(int pair, int count, double* above) {
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

// Bodies of one capsule or, as fingers, of several.
struct Bodies {
    std::vector<int> begins;    // (b + 1,) which capsules each one has
    std::vector<double> radii;  // (c,) [m]
    // Ends of all capsules' axes, (c, 3, count) [m] in some postures.
    const double *starts, *ends;
    size_t count;

    // Distance [m] of two bodies in a posture.
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

// A posture whose distances (p,) [m] are known.
struct Neighbour {
    const double* angles = nullptr;  // (n,) [rad]
    std::vector<double> lowest;      // (p,) [m]
    double least = 0.0;              // [m] of these
};

// How near postures may be, by the turns of hinges since neighbours: a pair comes no nearer than by what each reaches.
struct Reaches {
    int hinges = 0, pairs = 0;
    const double* of_pairs = nullptr;  // (p, n) [m]
    std::vector<double> farthest;      // (n,) [m] of any pair
    std::vector<double> turned[2];     // (n,) [rad] since both neighbours

    // Whether any pair may be nearer than a limit [m], as far as both neighbours tell.
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
