#include "ccd/pair_proof.h"

#include <algorithm>
#include <cmath>

#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::bisection;

namespace {

// In tolerances:
constexpr double kSureNormal = 0.1;   // the witness normal of a shallower overlap is noise
constexpr double kNegligible = 1e-6;  // a motion so short changes no distance that is measured

// MuJoCo's depths of these can be too shallow.
bool Curved(int type) { return type == mjGEOM_ELLIPSOID || type == mjGEOM_CYLINDER; }

}  // namespace

PairProof::PairProof(const SceneTables& tables, ContactFinder& finder)
    : tables_(tables),
      finder_(finder),
      motion_(tables),
      separation_(tables),
      q0_(tables.model->nq),
      dq_(tables.n),
      step_(tables.n),
      q_(tables.model->nq) {}

void PairProof::SetMotion(const CcdMotion& motion, double tolerance) {
  q0_ = motion.q0;
  dq_ = motion.dq;
  required_ = motion.required;
  tolerance_ = tolerance;
  motion_.SetPath(dq_);
}

void PairProof::At(double t, VectorXd& q) {
  q = q0_;
  if (t == 0.0) return;
  step_ = t * dq_;
  Integrate(tables_, q0_, step_, q);
}

void PairProof::PoseAt(double t) {
  step_ = t * dq_;
  Integrate(tables_, q0_, step_, q_);
  finder_.Pose(q_);
  motion_.SetPose(finder_.posed());
}

double PairProof::BodiesReach(int body_pair, double distance, double horizon) {
  double apart = 0.0;
  const double lambda = motion_.BodiesClosing(finder_.posed(), body_pair, horizon, apart);
  return (apart - distance) / lambda;
}

Reach PairProof::BoundsReach(int body_pair, int pair, double floor, double horizon) {
  Reach reach;
  reach.lambda = motion_.Closing(finder_.posed(), body_pair, pair, horizon);
  reach.length = (finder_.DistanceBound(pair) - Required(pair) - floor) / reach.lambda;
  return reach;
}

Margin PairProof::Measure(int pair, double enough) {
  const KeptPair& kept = tables_.pairs[pair];
  const PosedModel& posed = finder_.posed();
  const mjModel& m = *posed.model();
  Margin margin;
  margin.value = enough;
  NearPair near;
  if (!finder_.Distance(pair, enough + Required(pair), near)) return margin;
  margin.measured = true;
  margin.value = near.distance - Required(pair);
  margin.n_W = near.n_W;
  margin.p1_W = near.p1_W;
  if (m.geom_type[kept.geom1] == mjGEOM_PLANE) {
    margin.n_W = AsMatrix(posed.data()->geom_xmat + 9 * kept.geom1).col(2);
  }
  const bool curved = Curved(m.geom_type[kept.geom1]) || Curved(m.geom_type[kept.geom2]);
  if (curved && PartedByOnePlane(near.kind) && near.distance < -kSureNormal * tolerance_) {
    const double proven = separation_.Distance(posed, kept.geom1, kept.geom2, margin.n_W);
    margin.value = std::min(margin.value, proven - Required(pair));
  }
  return margin;
}

Reach PairProof::Prove(int body_pair, int pair, const Margin& margin, double floor,
                       Direction direction, double horizon) {
  const PosedModel& posed = finder_.posed();
  const double slack = margin.value - floor;
  Twist twist = motion_.TwistOf(body_pair, pair);
  if (direction == Direction::kEarlier) twist = twist.Backwards();
  Reach reach;
  reach.rate = -margin.n_W.dot(twist.v_W + twist.omega_W.cross(margin.p1_W));
  for (int i = 0; i < tune::kHorizons; ++i) {
    reach.lambda = motion_.Closing(posed, body_pair, pair, horizon);
    double proven = std::clamp(slack / reach.lambda, 0.0, horizon);
    if (i == 0 && reach.lambda * horizon <= kNegligible * tolerance_) proven = horizon;
    if (proven < horizon) {
      RelativeMotion motion = motion_.Geoms(posed, body_pair, pair, horizon);
      motion.twist = twist;  // in the direction that is asked for
      const double by_plane = separation_.SafeStep(posed, tables_.pairs[pair], margin.n_W, motion,
                                                   floor + Required(pair), horizon);
      proven = std::max(proven, by_plane);
    }
    reach.length = std::max(reach.length, proven);
    const double shorter =
        std::max(tune::kHorizonPerReach * reach.length, tune::kSmallestShrink * horizon);
    if (proven >= horizon || shorter > 0.5 * horizon) break;
    horizon = shorter;
  }
  return reach;
}

}  // namespace mjcf_pdg
