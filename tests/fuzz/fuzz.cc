// Random cases by the thousand, each of its own seed: cmake --build BUILD --target fuzz, then
// BUILD/fuzz verdict|solve|plan|bytes COUNT [FIRST_SEED]. Cases run in child processes, so that one
// that crashes, hangs or leaks (with the preset sanitize) is named by its seed and the others go
// on. Exits with 1 if anything was wrong.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <map>
#include <string>

#include "tests/fuzz/cases.h"

namespace {

using mjcf_pdg::test::CaseOutcome;
using Case = CaseOutcome (*)(std::uint64_t);

constexpr int kCasesOfAChild = 100;
constexpr unsigned kSeconds = 300;  // a case that takes longer hangs; with sanitizers all are slow

// Runs cases `seed` to `end` - 1 and writes a line for each to `out`, flushed.
[[noreturn]] void RunChild(Case run, std::uint64_t seed, std::uint64_t end, std::FILE* out) {
  {
    const mjcf_pdg::test::QuietMujoco quiet;
    for (; seed < end; ++seed) {
      alarm(kSeconds);
      CaseOutcome outcome;
      try {
        outcome = run(seed);
      } catch (const std::exception& e) {
        outcome = {"exception", e.what()};
      }
      for (char& c : outcome.wrong) c = c == '\n' ? ' ' : c;
      std::fprintf(out, "%s|%s\n", outcome.kind.c_str(), outcome.wrong.c_str());
      std::fflush(out);
    }
  }
  std::fclose(out);
  std::exit(0);  // here leaks are found
}

struct Tally {
  std::map<std::string, long> kinds;
  long wrong = 0;

  void Complain(const char* name, std::uint64_t seed, const std::string& what) {
    ++wrong;
    std::printf("%s %llu: %s\n", name, static_cast<unsigned long long>(seed), what.c_str());
    std::fflush(stdout);
  }
};

// Runs cases from `seed` on in one child and returns the seed behind the last that it came to.
std::uint64_t RunSome(const char* name, Case run, std::uint64_t seed, std::uint64_t end,
                      Tally& tally) {
  int ends[2];
  if (pipe(ends) != 0) std::abort();
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    RunChild(run, seed, end, fdopen(ends[1], "w"));
  }
  close(ends[1]);
  std::FILE* in = fdopen(ends[0], "r");
  char* line = nullptr;
  std::size_t room = 0;
  while (getline(&line, &room, in) > 0) {
    const std::string text(line);
    const std::size_t bar = text.find('|');
    ++tally.kinds[text.substr(0, bar)];
    const std::string wrong = text.substr(bar + 1, text.size() - bar - 2);
    if (!wrong.empty()) tally.Complain(name, seed, wrong);
    ++seed;
  }
  std::free(line);
  std::fclose(in);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    tally.Complain(name, seed, signal == SIGALRM ? "hangs" : strsignal(signal));
    return seed + 1;
  }
  if (WEXITSTATUS(status) != 0) {
    tally.Complain(name, seed, seed < end ? "ends the process" : "a leak in one of those before");
    return seed + (seed < end);
  }
  return seed;
}

}  // namespace

int main(int argc, char** argv) {
  const std::map<std::string, Case> cases = {{"verdict", mjcf_pdg::test::VerdictCase},
                                             {"solve", mjcf_pdg::test::SolvingCase},
#ifdef MJCF_PDG_HAVE_PLAN
                                             {"plan", mjcf_pdg::test::PlanningCase},
#endif
                                             {"bytes", mjcf_pdg::test::BytesCase}};
  const auto found = cases.find(argc > 1 ? argv[1] : "");
  if (argc < 3 || found == cases.end()) {
    std::fprintf(stderr, "usage: fuzz verdict|solve|plan|bytes COUNT [FIRST_SEED]\n");
    return 2;
  }
  const std::uint64_t count = std::strtoull(argv[2], nullptr, 10);
  std::uint64_t seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
  const std::uint64_t end = seed + count;
  Tally tally;
  while (seed < end) {
    seed = RunSome(argv[1], found->second, seed, std::min(end, seed + kCasesOfAChild), tally);
  }
  for (const auto& [kind, number] : tally.kinds) std::printf("%8ld %s\n", number, kind.c_str());
  std::printf("%8ld wrong\n", tally.wrong);
  return tally.wrong == 0 ? 0 : 1;
}
