// Impacts of a moving robot with a person, for `sim/impacts.py`: closed forms over a tree of rigid links with rotors.
//
// Spatial vectors (angular, linear) are about the world's origin, so that links need no transforms. The inverse inertia
// of a link, as a 6 x 6 matrix, follows from articulated-body inertias (Featherstone, "Rigid Body Dynamics Algorithms").

#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "lanes.h"

namespace kinesic::sim {

struct TreeHinge {
    int joint;
    double axis[3];
    double at[3];     // [m] offset of the axis from the link's origin
    double armature;  // [kg m^2] reflected inertia of the rotor
};

struct TreeLink {
    int parent;        // -1: the world
    double origin[3];  // [m] in the parent's frame
    double mass;       // [kg]
    double centre[3];  // [m] centre of mass
    double inertia[6]; // [kg m^2] about the centre: xx, yx, yy, zx, zy, zz
    std::vector<TreeHinge> hinges;
    std::vector<std::array<double, 3>> points;  // [m] points that may touch a person
};

// Largest impact of each posture, for rows of people.
struct ImpactRows {
    std::vector<double> inverse_masses;  // (r,) [1/kg] of the person's part
    std::vector<double> squared_scales;  // (r,) factors on v' (W + I / mass)^-1 v
};

struct ImpactTree {
    std::vector<TreeLink> links;

    // Writes ratios (m, r) and point indices (m, r) of postures and velocities (m, n).
    // A posture whose kinetic energy bounds all ratios by `gate` gets this bound, with the index -1. In other postures,
    // ratios below the gate are reported as the gate, with the index -1.
    void survey(const double* angles, const double* velocities, size_t joints, size_t count, const ImpactRows& rows,
                double gate, double* ratios, int64_t* points) const {
        Work work(links.size(), count_hinges());
        const size_t size = rows.inverse_masses.size();
        const double largest = *std::max_element(rows.squared_scales.begin(), rows.squared_scales.end());
        for (size_t k = 0; k < count; k += LANES) {
            const size_t part = std::min<size_t>(LANES, count - k);
            work.load(angles + k * joints, velocities + k * joints, joints, part);
            place(work);
            const Lane energy = add_energy(work) * 2.0;
            if (*std::max_element(energy.v, energy.v + LANES) * largest <= gate * gate) {
                for (size_t m = 0; m < part; ++m)
                    for (size_t r = 0; r < size; ++r) {
                        ratios[(k + m) * size + r] = std::sqrt(energy.v[m] * rows.squared_scales[r]);
                        points[(k + m) * size + r] = -1;
                    }
                continue;
            }
            invert(work);
            compare(work, rows, energy, gate, k, part, ratios, points);
        }
    }

    // Writes the Jacobian (m, 3, n) of one point in each posture (m, n).
    void jacobians(const double* angles, size_t joints, size_t count, const int64_t* points, double* columns) const {
        Work work(links.size(), count_hinges());
        std::fill_n(columns, count * 3 * joints, 0.0);
        for (size_t m = 0; m < count; ++m) {
            work.load(angles + m * joints, angles + m * joints, joints, 1);
            place(work);
            int64_t first = 0;
            size_t link = 0;
            while (points[m] >= first + int64_t(links[link].points.size())) first += int64_t(links[link++].points.size());
            const Lane3 at = world(work, link, links[link].points[size_t(points[m] - first)]);
            for (int l = int(link); l >= 0; l = links[size_t(l)].parent)
                for (size_t h = 0; h < links[size_t(l)].hinges.size(); ++h) {
                    const Lane6& axis = work.axes[work.first[size_t(l)] + h];
                    const Lane3 turned = cross({axis[0], axis[1], axis[2]}, at);
                    for (int i = 0; i < 3; ++i)
                        columns[(3 * m + i) * joints + links[size_t(l)].hinges[h].joint] = (axis[i + 3] + turned[i]).v[0];
                }
        }
    }

    size_t count_points() const {
        size_t sum = 0;
        for (const TreeLink& link : links) sum += link.points.size();
        return sum;
    }

private:
    struct Work {
        std::vector<Lane> angles, velocities;                // (n,)
        std::vector<std::array<Lane, 9>> rotations;          // (l,)
        std::vector<Lane3> origins;                          // (l,) [m]
        std::vector<Lane6> twists;                           // (l,) angular and linear velocity
        std::vector<Symmetric6> inertias, inverses;          // (l,) articulated inertia, inverse inertia
        std::vector<Lane6> axes, forces;                     // (h,) motion axis; articulated inertia times the axis
        std::vector<Lane> diagonals;                         // (h,) articulated inertia along the axis, with the rotor
        std::vector<size_t> first;                           // (l,) index of the link's first hinge

        Work(size_t count, size_t hinges)
            : rotations(count), origins(count), twists(count), inertias(count), inverses(count), axes(hinges),
              forces(hinges), diagonals(hinges), first(count) {}

        void load(const double* angle, const double* velocity, size_t joints, size_t part) {
            angles.resize(joints);
            velocities.resize(joints);
            for (size_t j = 0; j < joints; ++j)
                for (size_t m = 0; m < LANES; ++m) {
                    const size_t row = std::min(m, part - 1) * joints + j;
                    angles[j].v[m] = angle[row];
                    velocities[j].v[m] = velocity[row];
                }
        }
    };

    size_t count_hinges() const {
        size_t sum = 0;
        for (const TreeLink& link : links) sum += link.hinges.size();
        return sum;
    }

    static Lane3 rotated(const std::array<Lane, 9>& rotation, const double* vector) {
        Lane3 made;
        for (int i = 0; i < 3; ++i)
            made[i] = rotation[3 * i] * vector[0] + rotation[3 * i + 1] * vector[1] + rotation[3 * i + 2] * vector[2];
        return made;
    }

    static Lane3 world(const Work& work, size_t link, const std::array<double, 3>& point) {
        Lane3 at = rotated(work.rotations[link], point.data());
        for (int i = 0; i < 3; ++i) at[i] = at[i] + work.origins[link][i];
        return at;
    }

    // Computes frames, motion axes, twists and inertias of all links.
    void place(Work& work) const {
        size_t hinge = 0;
        for (size_t l = 0; l < links.size(); ++l) {
            const TreeLink& link = links[l];
            std::array<Lane, 9>& rotation = work.rotations[l];
            Lane3& origin = work.origins[l];
            Lane6& twist = work.twists[l];
            if (link.parent < 0) {
                for (int i = 0; i < 9; ++i) rotation[i] = Lane::of(i % 4 ? 0.0 : 1.0);
                for (int i = 0; i < 3; ++i) origin[i] = Lane::of(link.origin[i]);
                twist.fill(Lane::of(0.0));
            } else {
                const size_t parent = size_t(link.parent);
                rotation = work.rotations[parent];
                const Lane3 offset = rotated(rotation, link.origin);
                for (int i = 0; i < 3; ++i) origin[i] = work.origins[parent][i] + offset[i];
                twist = work.twists[parent];
            }
            work.first[l] = hinge;
            for (const TreeHinge& turn : link.hinges) {
                const Lane3 axis = rotated(rotation, turn.axis), before = rotated(rotation, turn.at);
                Lane3 anchor;
                for (int i = 0; i < 3; ++i) anchor[i] = origin[i] + before[i];
                const Lane3 linear = cross(anchor, axis);
                Lane6& motion = work.axes[hinge++];
                for (int i = 0; i < 3; ++i) {
                    motion[i] = axis[i];
                    motion[i + 3] = linear[i];
                }
                for (int i = 0; i < 6; ++i) twist[i] = twist[i] + motion[i] * work.velocities[size_t(turn.joint)];
                turned(turn.axis, work.angles[size_t(turn.joint)], rotation);
                const Lane3 after = rotated(rotation, turn.at);
                for (int i = 0; i < 3; ++i) origin[i] = anchor[i] - after[i];
            }
            work.inertias[l] = spatial_inertia(link, rotation, origin);
        }
    }

    static Symmetric6 spatial_inertia(const TreeLink& link, const std::array<Lane, 9>& r, const Lane3& origin) {
        Lane3 c = rotated(r, link.centre);
        for (int i = 0; i < 3; ++i) c[i] = c[i] + origin[i];
        const double* k = link.inertia;
        const double rows[3][3] = {{k[0], k[1], k[3]}, {k[1], k[2], k[4]}, {k[3], k[4], k[5]}};
        Symmetric6 made;
        Lane3 half[3];  // rotation times inertia, by row
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                half[i][j] = r[3 * i] * rows[0][j] + r[3 * i + 1] * rows[1][j] + r[3 * i + 2] * rows[2][j];
        const Lane square = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j <= i; ++j) {
                const Lane moved = i == j ? square - c[i] * c[j] : c[i] * c[j] * -1.0;
                made[entry(i, j)] =
                    half[i][0] * r[3 * j] + half[i][1] * r[3 * j + 1] + half[i][2] * r[3 * j + 2] + moved * link.mass;
            }
        const Lane zero = Lane::of(0.0), mass = Lane::of(link.mass);
        const Lane3 moment = {c[0] * link.mass, c[1] * link.mass, c[2] * link.mass};
        // lower left block: minus the mass times the cross product matrix of the centre
        const Lane3 block[3] = {{zero, moment[2], zero - moment[1]},
                                {zero - moment[2], zero, moment[0]},
                                {moment[1], zero - moment[0], zero}};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                made[entry(i + 3, j)] = block[i][j];
                if (j <= i) made[entry(i + 3, j + 3)] = i == j ? mass : zero;
            }
        return made;
    }

    // Returns the kinetic energy of links and rotors [J].
    Lane add_energy(const Work& work) const {
        Lane energy = Lane::of(0.0);
        for (size_t l = 0; l < links.size(); ++l) {
            energy = energy + dot(work.twists[l], product(work.inertias[l], work.twists[l]));
            for (const TreeHinge& turn : links[l].hinges) {
                const Lane& velocity = work.velocities[size_t(turn.joint)];
                energy = energy + velocity * velocity * turn.armature;
            }
        }
        return energy * 0.5;
    }

    // Computes the inverse inertia of every link, felt by a wrench on it.
    void invert(Work& work) const {
        for (size_t l = links.size(); l-- > 0;) {
            Symmetric6& inertia = work.inertias[l];
            for (size_t h = links[l].hinges.size(); h-- > 0;) {
                const size_t at = work.first[l] + h;
                const Lane6& axis = work.axes[at];
                Lane6& force = work.forces[at];
                force = product(inertia, axis);
                work.diagonals[at] = dot(axis, force) + links[l].hinges[h].armature;
                for (int i = 0; i < 6; ++i) {
                    const Lane part = force[i] / work.diagonals[at];
                    for (int j = 0; j <= i; ++j) inertia[entry(i, j)] = inertia[entry(i, j)] - part * force[j];
                }
            }
            if (links[l].parent >= 0) {
                Symmetric6& carrier = work.inertias[size_t(links[l].parent)];
                for (int i = 0; i < 21; ++i) carrier[i] = carrier[i] + inertia[i];
            }
        }
        for (size_t l = 0; l < links.size(); ++l) {
            Symmetric6& inverse = work.inverses[l];
            if (links[l].parent < 0) inverse.fill(Lane::of(0.0));
            else inverse = work.inverses[size_t(links[l].parent)];
            for (size_t h = 0; h < links[l].hinges.size(); ++h) {
                const size_t at = work.first[l] + h;
                const Lane6 &axis = work.axes[at], &force = work.forces[at];
                const Lane unit = Lane::of(1.0) / work.diagonals[at];
                const Lane6 felt = product(inverse, force);
                const Lane along = (dot(force, felt) * unit + 1.0) * unit;
                for (int i = 0; i < 6; ++i) {
                    const Lane mine = felt[i] * unit;
                    for (int j = 0; j <= i; ++j)
                        inverse[entry(i, j)] = inverse[entry(i, j)] - axis[i] * (felt[j] * unit) - mine * axis[j] +
                                               axis[i] * axis[j] * along;
                }
            }
        }
    }

    // Finds the point with the largest ratio of each row.
    void compare(const Work& work, const ImpactRows& rows, const Lane& energy, double gate, size_t k, size_t part,
                 double* ratios, int64_t* points) const {
        const size_t size = rows.inverse_masses.size();
        std::vector<Lane> best(size, Lane::of(gate * gate));
        std::vector<std::array<int64_t, LANES>> who(size);
        for (auto& indices : who) indices.fill(-1);
        int64_t point = 0;
        for (size_t l = 0; l < links.size(); ++l) {
            const Lane6& twist = work.twists[l];
            const Lane3 spin = {twist[0], twist[1], twist[2]};
            for (const auto& place : links[l].points) {
                const Lane3 at = world(work, l, place), swing = cross(spin, at);
                const Lane3 v = {twist[3] + swing[0], twist[4] + swing[1], twist[5] + swing[2]};
                const Lane square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
                std::array<Lane, 6> mobility;  // lower triangle of W
                bool known = false;
                for (size_t r = 0; r < size; ++r) {
                    const double scale = rows.squared_scales[r], factor = scale / rows.inverse_masses[r];
                    bool may_exceed = false;  // as neither the person's mass nor the robot's energy allows it
                    for (int m = 0; m < LANES; ++m)
                        may_exceed |= square.v[m] * factor > best[r].v[m] && energy.v[m] * scale > best[r].v[m];
                    if (!may_exceed) continue;
                    if (!known) mobility = mobility_at(work.inverses[l], at);
                    known = true;
                    const Lane value = quotient(mobility, rows.inverse_masses[r], v) * rows.squared_scales[r];
                    for (int m = 0; m < LANES; ++m)
                        if (value.v[m] > best[r].v[m]) {
                            best[r].v[m] = value.v[m];
                            who[r][size_t(m)] = point;
                        }
                }
                ++point;
            }
        }
        for (size_t m = 0; m < part; ++m)
            for (size_t r = 0; r < size; ++r) {
                ratios[(k + m) * size + r] = who[r][m] < 0 ? gate : std::sqrt(best[r].v[m]);
                points[(k + m) * size + r] = who[r][m];
            }
    }
};

}  // namespace kinesic::sim
