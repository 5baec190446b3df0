// Whether a configuration is free, asked of neither solver nor verifier: pairs, limits and
// constraints are read from the model anew, overlaps are judged by supporting planes
// (tests/support/brute_distance.h).
#ifndef MJCF_PDG_TESTS_FUZZ_JUDGE_H_
#define MJCF_PDG_TESTS_FUZZ_JUDGE_H_

#include <functional>
#include <string>
#include <vector>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

// A direction that somebody claims to part two geoms, from the first to the second. The judge
// believes the plane, which it measures itself, not the claim.
using PlaneHint = std::function<Eigen::Vector3d(int geom1, int geom2)>;

class Judge {
 public:
  // The model must outlive it. All joints move, and equality constraints are held but for those
  // that join a mocap body.
  explicit Judge(const mjModel& m);

  // Says what is wrong with the claim that q is free within `tolerance` [m]; empty: nothing. `hint`
  // is asked where the judge finds no plane by itself.
  std::string Refute(const std::vector<double>& q, double tolerance, const PlaneHint& hint);

 private:
  bool Kept(int geom1, int geom2) const;
  std::string RefutePair(int geom1, int geom2, double tolerance, const PlaneHint& hint) const;
  std::string RefuteLimits(const std::vector<double>& q) const;
  std::string RefuteEqualities(const std::vector<double>& q) const;
  double EqualityResidual(int equality, const std::vector<double>& q) const;

  const mjModel& m_;
  const DataPtr d_;
  std::vector<std::pair<int, int>> pairs_;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_FUZZ_JUDGE_H_
