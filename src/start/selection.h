// Free-configuration selection: where local optimization starts from.
//
// Source: Tang & Kim, Sec. 3.2 and 5.1.
// Differs from it: a start need not be free, since local optimization takes overlaps too; beside
// the paper's selections there are starts that only aim at another side of the obstacle.
#ifndef MJCF_PDG_SRC_START_SELECTION_H_
#define MJCF_PDG_SRC_START_SELECTION_H_

#include <span>
#include <vector>

#include "base/random.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

// How ContactHop moves joints. It takes a configuration `best` with contacts, picks one of them and
// decides it anew: the joints between the two bodies (all of them, or about half) move, all others
// stay. A model that overlaps in many places has a choice to make at each, and a start that draws
// all joints anew seldom makes all choices well.
enum class Hop {
  kFromBest,   // noise about `best`
  kFromInput,  // noise about q_in
  kMirrored,   // to the other side of q_in
};

struct FreeOnRay {
  VectorXd q;
  double sigma = 0.0;  // [m²]
};

// Each function writes the configuration that it makes to `start`, which must not be one of its
// other arguments. Calls do not depend on earlier ones; only memory is kept.
class StartSelection {
 public:
  explicit StartSelection(Workspace& work);

  // The mirror image of q about q_in: q_in ⊖ (q ⊖ q_in).
  void Mirrored(const VectorXd& q, VectorXd& start);

  // `center` moved by normal noise, each dof by about `spread` · √(sigma / n) of the object norm.
  // In half of the draws about half of the dofs stay: many answers move few joints.
  void Gaussian(const VectorXd& center, double sigma, double spread, Random& random,
                VectorXd& start);

  // See Hop; the noise's scale is one of three, drawn at random, about sigma's [m²].
  void ContactHop(const VectorXd& best, double sigma, Hop hop, Random& random, VectorXd& start);

  // Every joint anywhere: uniform within limits, hinges without limits and rotations all around,
  // slides and free bodies within ten Problem::size about `center`.
  void Uniform(const VectorXd& center, Random& random, VectorXd& start);

  // The configuration on the straight way from `center` through `q`, `times` as far as q.
  void Beyond(const VectorXd& center, const VectorXd& q, double times, VectorXd& start);

  // Eq. 20: the tree that overlaps most is carried off along its base's free directions, away from
  // the centroid of what it overlaps, by the radii of the enclosing spheres (and the clearance).
  // Candidates in the order to try: the projected direction, then ± the free directions. Empty if
  // every base is fixed or nothing but a tree itself overlaps. `overlaps` are the overlapping pairs
  // at `from`. Valid until the next call.
  std::span<const VectorXd> ConstrainedTranslation(const std::vector<NearPair>& overlaps,
                                                   const VectorXd& from);

  // Goes straight from `center` towards each of `far`, on all ways at once, and returns the first
  // free configuration found on each, by σ ascending. A way is left where its σ exceeds
  // `largest_sigma` [m²], or twice the least σ found on another. Valid until the next call.
  std::span<const FreeOnRay> FirstFree(const VectorXd& center, std::span<const VectorXd> far,
                                       double largest_sigma);

 private:
  // A direction in which a tree's base may be translated, and the tangent that does it.
  struct FreeDirection {
    Vector3d a_W;
    int col = 0;
  };

  void FindDofSteps(const VectorXd& at, double length);
  void MarkDofsOfSomeContact(const VectorXd& q, Random& random);
  void FindBaseDirections(int tree);
  void SplitGeoms(int tree, const std::vector<NearPair>& overlaps);
  void AddTranslation(const VectorXd& from, double distance, const Vector3d& direction_W);
  void MoveTo(const VectorXd& from, const VectorXd& dq, double t, VectorXd& out);
  bool RayEnds(const VectorXd& center, int ray, double before, double t, double& largest_sigma);
  void AddFound(const VectorXd& q);

  const Problem& problem_;
  Workspace& work_;
  VectorXd dq_, hopped_, scaled_, trial_, r_;
  MatrixXd J_;
  VectorXd steps_;             // how far each dof moves for some length
  VectorXd arms_;              // per dof: a turn counts as its arc at this distance [m]; slides 1
  std::vector<char> between_;  // n: the dofs between two bodies
  std::vector<int> touching_;  // pairs
  std::vector<FreeDirection> free_;
  std::vector<int> own_, others_;  // geoms of a tree, and of what it overlaps
  // These lists never shrink; of the first two, the entries up to the counts below are in use.
  std::vector<VectorXd> translations_, rays_;
  std::vector<FreeOnRay> found_;
  int num_translations_ = 0, num_found_ = 0;
  std::vector<int> open_;  // rays that have not ended
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_START_SELECTION_H_
