#include "plan/planners.h"

#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/samplers/informed/RejectionInfSampler.h>
#include <ompl/geometric/planners/est/BiEST.h>
#include <ompl/geometric/planners/est/EST.h>
#include <ompl/geometric/planners/est/ProjEST.h>
#include <ompl/geometric/planners/informedtrees/ABITstar.h>
#include <ompl/geometric/planners/informedtrees/AITstar.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/kpiece/BKPIECE1.h>
#include <ompl/geometric/planners/kpiece/KPIECE1.h>
#include <ompl/geometric/planners/kpiece/LBKPIECE1.h>
#include <ompl/geometric/planners/pdst/PDST.h>
#include <ompl/geometric/planners/rrt/BiTRRT.h>
#include <ompl/geometric/planners/rrt/InformedRRTstar.h>
#include <ompl/geometric/planners/rrt/LazyRRT.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTXstatic.h>
#include <ompl/geometric/planners/rrt/RRTsharp.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/geometric/planners/rrt/TRRT.h>
#include <ompl/geometric/planners/sbl/SBL.h>
#include <ompl/geometric/planners/stride/STRIDE.h>

#include <utility>

#include "plan/roadmap.h"

namespace mjcf_pdg {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

using Space = const ob::SpaceInformationPtr&;
using Input = const RetractionInput&;

template <typename Planner>
NamedPlanner Plain(Input, Space space) {
  return {std::make_shared<Planner>(space)};
}

// The first path will do: an optimizing planner that is not told so never ends.
class FirstPath : public ob::PathLengthOptimizationObjective {
 public:
  explicit FirstPath(Space space) : ob::PathLengthOptimizationObjective(space) {
    setCostThreshold(infiniteCost());
  }
  // OMPL's own sampler of what can better a path knows its own spaces only.
  ob::InformedSamplerPtr allocInformedStateSampler(const ob::ProblemDefinitionPtr& problem,
                                                   unsigned int most_calls) const override {
    return std::make_shared<ob::RejectionInfSampler>(problem, most_calls);
  }
};

template <typename Planner>
NamedPlanner Optimizing(Input, Space space) {
  return {.planner = std::make_shared<Planner>(space),
          .objective = std::make_shared<FirstPath>(space)};
}

template <bool star>
NamedPlanner OnRoadmap(Input, Space space) {
  return {.planner = std::make_shared<Roadmap>(space, star),
          .objective = std::make_shared<FirstPath>(space)};
}

NamedPlanner Retracting(const std::string& name, Retractions retractions, Space space) {
  const auto planner = std::make_shared<RetractingRrtConnect>(space, name, std::move(retractions));
  return {planner, planner.get()};
}

struct Entry {
  const char* name;
  NamedPlanner (*make)(Input, Space);
};

// Seconds per path on Placement and Bridge (seeds 701 to 712), by what the growing and the joining
// tree do: contact and nothing (birrt-r) 2.7 and 1.8, PDg and PDg 1.4 and 0.42, PDg and contact
// 0.81 and 0.53, contact and PDg (birrt-pdg) 0.66 and 0.32.
//
// Optimizing planners end with their first path. Left out are those with threads of their own
// (SPARS, pRRT, CForest), those that look at the clock too seldom (FMT: 16 s of 3 on Placement),
// those that lose memory (LazyPRM, SORRT*), those for other spaces or controls, and LBTRRT, which
// fails an assertion of its own.
constexpr Entry kPlanners[] = {
    {"birrt", Plain<og::RRTConnect>},
    {"birrt-r",
     [](Input input, Space space) {
       return Retracting("birrt-r", {MakeContactRetraction(input), nullptr}, space);
     }},
    {"birrt-pdg",
     [](Input input, Space space) {
       return Retracting("birrt-pdg", {MakeContactRetraction(input), MakePdgRetraction(input)},
                         space);
     }},
    {"rrt", Plain<og::RRT>},
    {"lazyrrt", Plain<og::LazyRRT>},
    {"trrt", Plain<og::TRRT>},
    {"est", Plain<og::EST>},
    {"biest", Plain<og::BiEST>},
    {"projest", Plain<og::ProjEST>},
    {"kpiece", Plain<og::KPIECE1>},
    {"bkpiece", Plain<og::BKPIECE1>},
    {"lbkpiece", Plain<og::LBKPIECE1>},
    {"pdst", Plain<og::PDST>},
    {"sbl", Plain<og::SBL>},
    {"stride", Plain<og::STRIDE>},
    {"rrtstar", Optimizing<og::RRTstar>},
    {"rrtsharp", Optimizing<og::RRTsharp>},
    {"rrtxstatic", Optimizing<og::RRTXstatic>},
    {"informedrrtstar", Optimizing<og::InformedRRTstar>},
    {"prm", OnRoadmap<false>},
    {"prmstar", OnRoadmap<true>},
    {"bitrrt", Plain<og::BiTRRT>},
    {"bitstar", Optimizing<og::BITstar>},
    {"abitstar", Optimizing<og::ABITstar>},
    {"aitstar", Optimizing<og::AITstar>},
};

}  // namespace

std::vector<std::string> PlannerNames() {
  std::vector<std::string> names;
  for (const Entry& entry : kPlanners) names.push_back(entry.name);
  return names;
}

bool BeginsAnew(const std::string& planner) { return planner == "birrt" || Retracts(planner); }

bool Retracts(const std::string& planner) { return planner == "birrt-r" || RetractsByPdg(planner); }

bool RetractsByPdg(const std::string& planner) { return planner == "birrt-pdg"; }

NamedPlanner MakePlanner(const std::string& name, double range, const RetractionInput& input,
                         const ob::SpaceInformationPtr& space) {
  std::string known;
  for (const Entry& entry : kPlanners) {
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
    if (name != entry.name) continue;
    NamedPlanner made = entry.make(input, space);
    if (made.planner->params().hasParam("range")) {
      made.planner->params().setParam("range", std::to_string(range));
    }
    return made;
  }
  throw Error("no planner '" + name + "' (planners: " + known + ")");
}

}  // namespace mjcf_pdg
