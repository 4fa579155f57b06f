// The solver of arms without Python: an arm and questions in, answers out, each number with all its bits.
// Input: hinges, links, seeds; the arm as tests/ik/test_other_processors.py writes it; then questions, one after another:
// "solve" and "hold" with place, pointing, palm and start, "reach" with place and start.

#include <cstdio>
#include <cstring>

#include "arm_nearest.h"
#include "arm_pose.h"

using namespace kinesic::arm;

static double number() {
    double value = NAN;
    if (std::scanf("%lf", &value) != 1) std::exit(1);
    return value;
}

static Vector vector() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
}

static void told(const double* values, int count) {
    for (int k = 0; k < count; ++k) std::printf("%a ", values[k]);
}

static Linkage linkage_read() {
    Linkage arm;
    arm.hinges = int(number());
    arm.links = int(number());
    arm.seeds = int(number());
    arm.origin = vector();
    arm.palm = unit(vector());
    arm.side = number();
    arm.farthest = number();
    arm.closest = number();
    for (int j = 0, first = 0; j < arm.links; first += arm.link[j++].count) {
        const int count = int(number());
        const Vector bone = vector();
        arm.link[j] = {first, count, bone, unit(bone), norm(bone)};
    }
    for (int k = 0; k < arm.hinges; ++k) {
        const Vector axis = vector();
        const double lower = number(), upper = number(), rest = number();
        arm.pivot[k] = Pivot(axis, lower, upper, rest);
    }
    arm.draw_arcs();
    for (int n = 0; n < arm.seeds; ++n) {
        for (int k = 0; k < arm.own(); ++k) arm.seed[n].angles[k] = number();
        arm.seed[n].hand = hand(arm, arm.seed[n].angles);
    }
    return arm;
}

int main() {
    static Linkage arm = linkage_read();
    double rest[MOST_HINGES], mobility[MOST_HINGES], angles[MOST_HINGES];
    for (int k = 0; k < arm.hinges; ++k) rest[k] = arm.pivot[k].clipped(arm.pivot[k].rest);
    for (int k = 0; k < arm.hinges; ++k) mobility[k] = number();
    for (char what[16]; std::scanf("%15s", what) == 1; std::printf("\n")) {
        const Vector place = vector();
        const bool reach = !std::strcmp(what, "reach");
        const Vector ahead = reach ? Vector{} : unit(vector()), facing = reach ? Vector{} : unit(vector());
        for (int k = 0; k < arm.hinges; ++k) angles[k] = arm.pivot[k].clipped(number());
        if (reach) {
            const Polished best = approach(arm, place, angles, rest, mobility);
            told(best.angles, arm.own());
        } else if (!std::strcmp(what, "hold")) {
            Pose pose;
            pose.position = place;
            std::copy_n(angles, arm.hinges, pose.near);
            if (!orientation_of(arm.last().along, arm.palm, ahead, facing, pose.wanted)) return 1;
            const Held held = hold(arm, pose, mobility);
            told(held.angles, arm.hinges);
        } else {
            Question question;
            question.position = place;
            question.wishes[0] = {arm.last().along, ahead};
            question.wishes[1] = {arm.palm, facing};
            question.wish_count = 2;
            std::copy_n(angles, arm.hinges, question.near);
            std::copy_n(rest, arm.hinges, question.home);
            std::copy_n(mobility, arm.hinges, question.mobility);
            const Answer found = answer(arm, question, rest, mobility);
            told(found.angles, arm.hinges);
        }
    }
    return 0;
}
