// Chain of segments from the root to a segment, for two hands (kinesic/ik/two_hands.py, Strand).

#pragma once

#include "arm_linkage.h"

namespace kinesic::pair {

using arm::Pivot;
using arm::Rotation;
using arm::Vector;

constexpr int MAX_SEGMENTS = 24;
constexpr int MAX_HINGES = 48;

struct Hinge {
    int joint = 0;  // index in the robot's joint order
    Pivot pivot;
    Vector at;  // [m] point on its axis, relative to the segment's centre
};

struct Strand {
    int parts = 0, hinges = 0;
    Vector offset[MAX_SEGMENTS];       // [m] centre of a segment in its parent
    int end[MAX_SEGMENTS];             // one past the last hinge of a segment
    Hinge hinge[MAX_HINGES];
};

struct Lines {  // the axis of each hinge in the world, with a point on it [m]
    Vector axis[MAX_HINGES], pole[MAX_HINGES];
};

// Returns the end's centre [m] in the world and its frame.
inline Vector walk(const Strand& strand, const double* angles, Lines& lines, Rotation& frame) {
    Vector centre;
    frame = Rotation{};
    for (int part = 0, k = 0; part < strand.parts; ++part) {
        centre = centre + rotated(frame, strand.offset[part]);
        for (; k < strand.end[part]; ++k) {
            const Hinge& hinge = strand.hinge[k];
            lines.pole[k] = centre + rotated(frame, hinge.at);
            lines.axis[k] = rotated(frame, hinge.pivot.axis);
            frame = behind(frame, hinge.pivot, angles[hinge.joint]);
            centre = lines.pole[k] - rotated(frame, hinge.at);
        }
    }
    return centre;
}

}  // namespace kinesic::pair
