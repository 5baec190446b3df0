// Starts that differ from solve to solve by the seed alone: noise about q_in, hops that decide one
// contact of the best answer anew, the other side of q_in, anywhere.
//
// In deep problems, the side of an obstacle on which a start lies decides which optimum is found.
// Where triangle meshes overlap, the depth at a start says little; so such a start is moved to the
// first free configuration on the straight way from q_in through it.
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

  // Begins a search about `center`. `on_rays`: triangle meshes overlap there, so that starts are
  // moved to where they are free.
  void Begin(const EffortPlan& plan, const VectorXd& center, bool on_rays);

  void TryMirror();
  // Tries noise and hops in turn until the search is done. As long as nothing free is known it
  // tries noise alone, EffortPlan::blind times at most.
  void TryUntilDone();
  // For problems where nothing near q_in was found free: the translations of Eq. 20 for the
  // overlaps at q_in, until one leads to something free.
  void TryTranslations(const std::vector<NearPair>& overlaps);
  // For the same: configurations anywhere within limits, until one leads to something free.
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
