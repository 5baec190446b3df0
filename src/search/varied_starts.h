// Starts that differ from solve to solve by the seed alone: noise about q_in, hops that decide one
// contact of the best answer anew, the other side of q_in, anywhere.
//
// Deep problems are decided by which side of an obstacle, or which order of contacts, a start falls
// on. How deep two triangle meshes overlap says little, so theirs are moved on along the way there
// to where they are apart first.
#ifndef MJCF_PDG_SRC_SEARCH_VARIED_STARTS_H_
#define MJCF_PDG_SRC_SEARCH_VARIED_STARTS_H_

#include <vector>

#include "base/random.h"
#include "paper/contact_space_iteration.h"
#include "problem/effort.h"
#include "problem/workspace.h"
#include "search/trials.h"
#include "start/selection.h"

namespace mjcf_pdg {

class VariedStarts {
 public:
  VariedStarts(Workspace& work, Trials& trials)
      : problem_(work.problem()),
        work_(work),
        trials_(trials),
        starts_(work),
        iteration_(work),
        random_(0),
        start_(problem_.tables.model->nq),
        far_(problem_.tables.model->nq) {}

  // A search about `center` begins; `on_rays`: triangle meshes overlap.
  void Begin(const EffortPlan& plan, const VectorXd& center, bool on_rays);

  void TryMirror();
  // Noise and hops in turn until the search is done; noise alone, `blind` times, while nothing is
  // free.
  void TryUntilDone();
  // Where nothing near q_in worked: Eq. 20 for the overlaps at q_in, until something is free.
  void TryTranslations(const std::vector<NearPair>& overlaps);
  // ... and uniform within limits.
  void TryAnywhere();

  Random& random() { return random_; }

 private:
  void TryNoise(double spread);
  void TryHop(Hop hop);
  void TryOnRay(const VectorXd& q, Component start);
  void TryFreePose(const VectorXd& q_f, Component start);

  const Problem& problem_;
  Workspace& work_;
  Trials& trials_;
  StartSelection starts_;
  ContactSpaceIteration iteration_;
  Random random_;
  EffortPlan plan_;
  VectorXd center_;
  VectorXd start_, far_;  // scratch
  bool on_rays_ = false;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_VARIED_STARTS_H_
