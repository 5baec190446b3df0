// A program that runs beside the test, and whose lines of output the test waits for.
#ifndef MJCF_PDG_TESTS_SUPPORT_CHILD_PROCESS_H_
#define MJCF_PDG_TESTS_SUPPORT_CHILD_PROCESS_H_

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace mjcf_pdg::test {

class ChildProcess {
 public:
  // Starts the program (looked for in PATH) in the folder `cwd`, with `variables` ("NAME=value")
  // added to the environment. Its lines come from its descriptor `output` (1: stdout, ...); its
  // stderr goes to the file `errors`.
  struct Start {
    std::vector<std::string> arguments;  // the program first
    std::string cwd = ".", errors = "/dev/null";
    std::vector<std::string> variables = {};
    int output = 1;
  };
  explicit ChildProcess(const Start& start);
  ~ChildProcess();  // ends it, if it still runs
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // The next line, without its line break. Nothing if the output ends, or after a minute.
  std::optional<std::string> ReadLine();
  // Waits for the end, at most a minute. The exit code; -1: ended by a signal, or not at all.
  int Wait();

 private:
  pid_t pid_ = -1;
  int descriptor_ = -1;
  std::string read_;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_CHILD_PROCESS_H_
