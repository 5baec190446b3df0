#include "tests/support/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

namespace mjcf_pdg::test {
namespace {

constexpr int kPatience = 60000;  // [ms]: far longer than anything takes, so that a test ends

std::vector<char*> Pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

ChildProcess::ChildProcess(const Start& start) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, start.cwd.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, 2, start.errors.c_str(), flags, 0600);
  posix_spawn_file_actions_adddup2(&actions, ends[1], start.output);
  std::vector<std::string> arguments = start.arguments, variables = start.variables;
  for (char** variable = environ; *variable; ++variable) variables.push_back(*variable);
  const int failed = posix_spawnp(&pid_, arguments[0].c_str(), &actions, nullptr,
                                  Pointers(arguments).data(), Pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  descriptor_ = ends[0];
  if (failed != 0) {
    pid_ = -1;
    throw std::runtime_error("cannot run " + arguments[0]);
  }
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  close(descriptor_);
}

std::optional<std::string> ChildProcess::ReadLine() {
  for (;;) {
    if (const std::size_t end = read_.find('\n'); end != std::string::npos) {
      std::string line = read_.substr(0, end);
      read_.erase(0, end + 1);
      return line;
    }
    pollfd wait = {descriptor_, POLLIN, 0};
    char bytes[65536];
    if (poll(&wait, 1, kPatience) <= 0) return std::nullopt;
    const ssize_t count = read(descriptor_, bytes, sizeof bytes);
    if (count <= 0) return std::nullopt;
    read_.append(bytes, static_cast<std::size_t>(count));
  }
}

int ChildProcess::Wait() {
  while (ReadLine()) continue;  // its output ends with it, or it hangs
  pollfd end = {static_cast<int>(syscall(SYS_pidfd_open, pid_, 0)), POLLIN, 0};
  const bool ended = poll(&end, 1, kPatience) > 0;
  close(end.fd);
  int status = 0;
  if (!ended || waitpid(pid_, &status, 0) != pid_) return -1;
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace mjcf_pdg::test
