#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "library/questions.h"
#include "measure.h"

namespace mjcf_pdg::bench {
namespace {

// An answer counts as wrong if its relative error (see Table::Add) is larger.
constexpr double kWrong = 1e-3;

}  // namespace

double Seconds(const std::function<void()>& ask) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kRepeats; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    ask();
    least = std::min(
        least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return least;
}

void Score::Add(double time, double error) {
  seconds.push_back(time);
  if (error == kNoAnswer) {
    ++unanswered;
  } else if (error > kWrong) {
    ++wrong;
  } else {
    largest_error = std::max(largest_error, error);
  }
}

void Table::Add(const std::string& kind, const std::string& name, double seconds, double error) {
  if (scores_.find(kind) == scores_.end()) kinds_.push_back(kind);
  scores_[kind][name].Add(seconds, error);
}

void Table::Print(const std::vector<std::string>& names) const {
  std::printf("%-46s %-12s %6s %10s %6s %10s %6s %6s\n", "question", "by", "n", "median us",
              "ratio", "max error", "wrong", "none");
  for (const std::string& kind : kinds_) {
    const std::map<std::string, Score>& scores = scores_.at(kind);
    const double own = Quantile(scores.at(names.front()).seconds, 0.5);
    for (const std::string& name : names) {
      const auto found = scores.find(name);
      if (found == scores.end()) continue;
      const Score& s = found->second;
      const double median = Quantile(s.seconds, 0.5);
      std::printf("%-46s %-12s %6zu %10.3f %6.2f %10.1e %6d %6d\n", kind.c_str(), name.c_str(),
                  s.seconds.size(), 1e6 * median, median / own, s.largest_error, s.wrong,
                  s.unanswered);
    }
  }
  std::fflush(stdout);
}

std::vector<std::unique_ptr<Library>> Libraries(const mjModel& m, bool triangles) {
  std::vector<std::unique_ptr<Library>> libraries;
  for (auto make : {MakeFcl, MakeCoal}) {
    if (auto library = make(m, triangles)) libraries.push_back(std::move(library));
  }
  return libraries;
}

}  // namespace mjcf_pdg::bench
