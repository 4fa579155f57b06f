// Forward kinematics of a whole motion, for `sim/kinematics.py`. Postures are contiguous in memory for SIMD lanes.

#pragma once

#include <algorithm>
#include <vector>

namespace kinesic::sim {

struct HingeRotation {
    int joint;
    double axis[3];
    bool has_offset;  // whether the axis misses the segment's origin
    double at[3];     // [m] offset of the axis from the origin
};

struct Link {
    int parent;  // -1: the world
    double origin[3];  // [m] in the parent's frame
    std::vector<HingeRotation> turns;
};

// Computes rotations (s, 3, 3, m) and origins (s, 3, m) of chosen segments from sines and cosines (n, stride) of hinges.
struct MotionFrames {
    std::vector<Link> links;

    void solve(const std::vector<char>& chosen, const double* sines, const double* cosines, size_t stride, int count,
               double* rotations, double* origins) const {
        std::vector<double> before;
        for (size_t k = 0; k < links.size(); ++k) {
            if (!chosen[k]) continue;
            double *rotation = rotations + 9 * k * count, *origin = origins + 3 * k * count;
            place(links[k], rotations, origins, count, rotation, origin);
            for (const HingeRotation& turn : links[k].turns) {
                if (turn.has_offset) before.assign(rotation, rotation + 9 * size_t(count));
                apply(turn, sines + turn.joint * stride, cosines + turn.joint * stride, count, rotation);
                if (turn.has_offset) shift(turn, before.data(), rotation, count, origin);
            }
        }
    }

private:
    static void place(const Link& link, const double* rotations, const double* origins, int count, double* rotation,
                      double* origin) {
        if (link.parent < 0) {
            for (int i = 0; i < 9; ++i) std::fill_n(rotation + size_t(i) * count, count, i % 4 ? 0.0 : 1.0);
            for (int i = 0; i < 3; ++i) std::fill_n(origin + size_t(i) * count, count, link.origin[i]);
            return;
        }
        const double* turned = rotations + 9 * size_t(link.parent) * count;
        const double* from = origins + 3 * size_t(link.parent) * count;
        std::copy_n(turned, 9 * size_t(count), rotation);
        for (int i = 0; i < 3; ++i) {
            const double *x = turned + size_t(3 * i) * count, *y = x + count, *z = y + count;
            for (int m = 0; m < count; ++m)
                origin[i * count + m] =
                    from[i * count + m] + (link.origin[0] * x[m] + link.origin[1] * y[m] + link.origin[2] * z[m]);
        }
    }

    // R (I + sin K + (1 - cos) K^2) with the axis' cross product matrix K: Rodrigues' formula, row by row of R.
    static void apply(const HingeRotation& turn, const double* sine, const double* cosine, int count, double* rotation) {
        const double *a = turn.axis;
        int along = -1;
        for (int i = 0; i < 3; ++i)
            if (a[(i + 1) % 3] == 0.0 && a[(i + 2) % 3] == 0.0) along = i;
        for (int i = 0; i < 3; ++i) {
            double* row = rotation + size_t(3 * i) * count;
            if (along >= 0) {  // the rotation only mixes two columns
                double *first = row + size_t((along + 1) % 3) * count, *second = row + size_t((along + 2) % 3) * count;
                for (int m = 0; m < count; ++m) {
                    const double s = sine[m] * a[along], u = first[m], v = second[m];
                    first[m] = cosine[m] * u + s * v;
                    second[m] = cosine[m] * v - s * u;
                }
                continue;
            }
            double *x = row, *y = row + count, *z = y + count;
            for (int m = 0; m < count; ++m) {
                const double u = x[m], v = y[m], w = z[m], c = 1 - cosine[m];
                const double ou = a[2] * v - a[1] * w, ov = a[0] * w - a[2] * u, ow = a[1] * u - a[0] * v;
                x[m] = u + sine[m] * ou + c * (a[2] * ov - a[1] * ow);
                y[m] = v + sine[m] * ov + c * (a[0] * ow - a[2] * ou);
                z[m] = w + sine[m] * ow + c * (a[1] * ou - a[0] * ov);
            }
        }
    }

    static void shift(const HingeRotation& turn, const double* before, const double* after, int count, double* origin) {
        for (int i = 0; i < 3; ++i)
            for (int m = 0; m < count; ++m) {
                double moved = 0.0;
                for (int j = 0; j < 3; ++j)
                    moved += turn.at[j] * (before[(3 * i + j) * count + m] - after[(3 * i + j) * count + m]);
                origin[i * count + m] += moved;
            }
    }
};

}  // namespace kinesic::sim
