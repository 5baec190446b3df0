#include "apps/html/solved_row.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "apps/console/text.h"
#include "apps/html/joint_moves.h"
#include "apps/output/report.h"

namespace mjcf_pdg::app {
namespace {

using Json = nlohmann::ordered_json;

// On the slider; more are thinned out.
constexpr std::size_t kFrames = 40;  // of one descent
constexpr std::size_t kTrajectoryFrames = 400;

Json Facts(const Result& result) {
  Json facts = Json::array(
      {PageFact("√σ, how far (rms), mm", 1e3 * std::sqrt(result.sigma)),
       PageFact("no free configuration is nearer than, mm",
                1e3 * std::sqrt(result.sigma_lower_bound)),
       PageFact("σ, m²", result.sigma),
       PageFact("depth as given, mm", std::max(0.0, -1e3 * result.depth_in)),
       PageFact("smallest distance now, mm", 1e3 * result.min_distance),
       PageFact("start that won", result.start), PageFact("iterations", result.stats.iterations),
       PageFact(kQueriesFact, result.stats.collision_queries),
       PageFact("certified by signed distances", result.certified ? "yes" : "no")});
  if (result.limit_excess_in > kLimitTolerance) {
    facts.push_back(
        PageFact("joint limits exceeded as given by, rad or m", result.limit_excess_in));
  }
  const auto add = [&facts](const char* name, double violated) {
    if (violated > kEqualityTolerance) facts.push_back(PageFact(name, violated));
  };
  add("equalities violated as given by, m or rad", result.equality_residual_in);
  add("equalities violated now by, m or rad", result.equality_residual);
  add("tendon limits exceeded as given by, m", result.tendon_excess_in);
  add("tendon limits exceeded now by, m", result.tendon_excess);
  return facts;
}

// The descent that found the nearest free configuration, but for the last one, which polishes; -1:
// none.
int BestDescent(const std::vector<KeptIteration>& iterations) {
  const KeptIteration* best = nullptr;
  for (const KeptIteration& it : iterations) {
    if (it.free && it.start != "polish" && (!best || it.sigma < best->sigma)) best = &it;
  }
  return best ? best->descent : iterations.empty() ? -1 : iterations.front().descent;
}

std::vector<PageFrame> Frames(const SolvedRow& solved) {
  std::vector<PageFrame> frames = {{solved.row.q, "as given"}};
  std::vector<int> steps;  // of the descent that led to the answer
  const int descent = BestDescent(solved.iterations);
  for (std::size_t k = 0; k < solved.iterations.size(); ++k) {
    if (solved.iterations[k].descent == descent) steps.push_back(static_cast<int>(k));
  }
  const std::size_t stride = steps.size() / kFrames + 1;
  for (std::size_t k = 0; k < steps.size(); k += stride) {
    const KeptIteration& it = solved.iterations[static_cast<std::size_t>(steps[k])];
    frames.push_back(
        {it.q,
         "descent " + std::to_string(it.descent) + " (" + it.start + "), step " +
             std::to_string(it.step) + ": √σ " + Short(1e3 * std::sqrt(it.sigma)) + " mm, " +
             (it.free ? "free" : "overlaps " + Short(1e3 * it.violation) + " mm in sum"),
         steps[k]});
  }
  frames.push_back({solved.result.q, solved.result.status == Status::kUnsolved
                                         ? "the least overlap that was found"
                                         : "the answer, verified"});
  return frames;
}

}  // namespace

PageRow SolvedPageRow(const Scene& scene, Metric metric, const SolvedRow& solved) {
  const Result& result = solved.result;
  PageRow row;
  row.of = solved.row;
  row.status = StatusName(result.status);
  row.wrong = result.status == Status::kUnsolved;
  row.frames = Frames(solved);
  row.content = {{"facts", Facts(result)},
                 {"reason", result.reason},
                 {"contacts_in", PageContacts(scene, result.contacts_in)},
                 {"contacts", PageContacts(scene, result.contacts)},
                 {"joints", PageJoints(scene, metric, row.frames, row.frames.size() - 1)},
                 {"iterations", Json::array()}};
  for (const KeptIteration& it : solved.iterations) {
    row.content["iterations"].push_back({{"start", it.start},
                                         {"descent", it.descent},
                                         {"step", it.step},
                                         {"sigma", it.sigma},
                                         {"free", it.free}});
  }
  return row;
}

PageRow TrajectoryPageRow(const std::vector<PageFrame>& answers,
                          const std::vector<std::size_t>& unsolved) {
  PageRow row;
  row.of.label = "all frames";
  row.status = "motion";
  row.wrong = !unsolved.empty();
  const std::size_t stride = answers.size() / kTrajectoryFrames + 1;
  for (std::size_t k = 0; k < answers.size(); k += stride) row.frames.push_back(answers[k]);
  if ((answers.size() - 1) % stride != 0) row.frames.push_back(answers.back());
  row.content = {{"facts", Json::array({PageFact("frames", answers.size())})},
                 {"before", "the first frame"}};
  if (row.wrong) {
    row.content["facts"].push_back(PageFact("not solved", unsolved.size()));
    const std::size_t more = unsolved.size() - 1;
    row.content["reason"] = answers[unsolved.front()].label +
                            (more > 0 ? ", and " + std::to_string(more) + " more" : "") +
                            ". The list of rows says why.";
    row.content["opens"] = unsolved.front() / stride;
  }
  return row;
}

}  // namespace mjcf_pdg::app
