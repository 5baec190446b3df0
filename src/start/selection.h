// Free-configuration selection: where local optimization starts from.
//
// Source: Tang & Kim, Sec. 3.2 and 5.1.
// Differs from it: a start need not be free, since local optimization takes overlaps too; beside
// the paper's selections there are starts that only aim at another side of the obstacle.
#ifndef MJCF_PDG_SRC_START_SELECTION_H_
#define MJCF_PDG_SRC_START_SELECTION_H_

#include <vector>

#include "base/random.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

// q_in moved as far to the other side as q lies on this one: q_in ⊖ (q ⊖ q_in).
VectorXd MirroredStart(Workspace& work, const VectorXd& q);

// `center` moved by normal noise, each dof by about `spread` · √(sigma / n) of the object norm.
// In half of the draws about half of the dofs stay: many answers move few joints.
VectorXd GaussianStart(Workspace& work, const VectorXd& center, double sigma, double spread,
                       Random& random);

// `best`, a configuration in contact, with one contact decided anew: the joints between its two
// bodies (all of them, or about half) move, the others stay as they are. A model that overlaps in
// many places has as many choices to make, and a fresh start seldom makes all of them well.
enum class Hop {
  kFromBest,   // noise about `best`
  kFromInput,  // noise about q_in
  kMirrored,   // to the other side of q_in
};
VectorXd ContactHop(Workspace& work, const VectorXd& best, double sigma, Hop hop, Random& random);

// Straight from `center` towards each of `far`, all at one pace: the first free configuration found
// on each way, the least σ first. Ways on which σ would be more than `largest_sigma` [m²], or more
// than twice the least found, are given up.
struct FreeOnRay {
  VectorXd q;
  double sigma = 0.0;  // [m²]
};
std::vector<FreeOnRay> FirstFree(Workspace& work, const VectorXd& center,
                                 const std::vector<VectorXd>& far, double largest_sigma);

// On the way from `center` through `q`, `times` as far.
VectorXd Beyond(Workspace& work, const VectorXd& center, const VectorXd& q, double times);

// Every joint anywhere: uniform within limits, hinges without limits and rotations all around,
// slides and free bodies within ten Problem::size about `center`.
VectorXd UniformStart(Workspace& work, const VectorXd& center, Random& random);

// Eq. 20: the tree that overlaps most is carried off along its base's free directions, away from
// the centroid of what it overlaps, by the radii of the enclosing spheres (and the clearance).
// Candidates in the order to try: the projected direction, then ± the free directions. Empty if
// every base is fixed or nothing but a tree itself overlaps. `overlaps` are the overlapping pairs
// at `from`.
std::vector<VectorXd> ConstrainedTranslation(Workspace& work, const std::vector<NearPair>& overlaps,
                                             const VectorXd& from);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_START_SELECTION_H_
