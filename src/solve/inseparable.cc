#include "solve/inseparable.h"

#include <algorithm>
#include <array>
#include <vector>

#include "base/names.h"
#include "base/random.h"
#include "start/selection.h"

namespace mjcf_pdg {
namespace {

constexpr int kTried = 100;        // configurations
constexpr std::size_t kNamed = 8;  // <exclude> lines

// Pairs that overlap at q, ascending. Triangles that cross may do no more than touch. One query.
std::vector<int> OverlappingPairs(Workspace& work, const VectorXd& q) {
  std::vector<int> pairs;
  work.finder.Pose(q);
  for (const NearPair& near : work.finder.Find(work.problem().clearance, Depths::kSkipped)) {
    if (!NeedsGap(near.kind) && work.problem().Overlaps(near, work.problem().tolerances.user))
      pairs.push_back(near.pair);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<int> InseparablePairs(Workspace& work, const VectorXd& q) {
  if (work.Spent()) return {};
  Random random(work.problem().options.seed);
  StartSelection starts(work);
  VectorXd start;
  std::vector<int> pairs = OverlappingPairs(work, q);
  for (int k = 0; k < kTried && !pairs.empty(); ++k) {
    if (work.Spent()) return {};
    starts.Uniform(work.problem().q_in, random, start);
    const std::vector<int> here = OverlappingPairs(work, start);
    std::erase_if(
        pairs, [&here](int pair) { return !std::binary_search(here.begin(), here.end(), pair); });
  }
  return pairs;
}

// Only bodies with names can be excluded.
std::string ExcludeLine(const mjModel& m, int body1, int body2) {
  const std::string name1 = QuotedNameOrId(m, mjOBJ_BODY, body1);
  const std::string name2 = QuotedNameOrId(m, mjOBJ_BODY, body2);
  if (name1[0] == '#' || name2[0] == '#') return "bodies " + name1 + " and " + name2;
  return "<exclude body1=" + name1 + " body2=" + name2 + "/>";
}

}  // namespace

std::string DescribeInseparable(Workspace& work, const VectorXd& q) {
  const std::vector<int>& columns = work.problem().tables.column_of_dof;
  if (std::find(columns.begin(), columns.end(), -1) != columns.end()) return "";
  const mjModel& m = *work.problem().tables.model;
  std::vector<std::array<int, 2>> bodies;
  for (const int index : InseparablePairs(work, q)) {
    const KeptPair& pair = work.problem().tables.pairs[index];
    const auto [low, high] = std::minmax(m.geom_bodyid[pair.geom1], m.geom_bodyid[pair.geom2]);
    const std::array<int, 2> two = {low, high};
    if (std::find(bodies.begin(), bodies.end(), two) == bodies.end()) bodies.push_back(two);
  }
  if (bodies.empty()) return "";
  std::string text =
      "; overlaps in each of " + std::to_string(kTried) + " random configurations, too:";
  for (std::size_t k = 0; k < std::min(kNamed, bodies.size()); ++k) {
    text += (k == 0 ? " " : ", ") + ExcludeLine(m, bodies[k][0], bodies[k][1]);
  }
  if (bodies.size() > kNamed) text += " and " + std::to_string(bodies.size() - kNamed) + " more";
  return text;
}

}  // namespace mjcf_pdg
