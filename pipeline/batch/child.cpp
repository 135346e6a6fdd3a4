#include "pipeline/batch/child.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::batch {
namespace {

constexpr int kNotStarted = 127;  // as shells have it

[[noreturn]] void fail_with_errno(const std::string& what, int error) {
  throw Error(ErrorKind::kFile, what + " (" + std::generic_category().message(error) + ")");
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

std::vector<std::string> environment_with(const Variables& variables) {
  std::vector<std::string> all;
  for (char** one = environ; *one != nullptr; ++one) {
    const std::string text = *one;
    const bool replaced = std::any_of(variables.begin(), variables.end(), [&](const auto& variable) {
      return text.starts_with(variable.first + "=");
    });
    if (!replaced) all.push_back(text);
  }
  for (const auto& [name, value] : variables) all.push_back(name + "=" + value);
  return all;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> list;
  for (std::string& text : texts) list.push_back(text.data());
  list.push_back(nullptr);
  return list;
}

// What the child does before its program: between fork and exec only system calls are allowed.
struct Start {
  pid_t parent;
  int stdin_fd, stderr_fd;
  rlimit memory;
  char** words;
  char** environment;

  [[noreturn]] void run() const {
    ::setpgid(0, 0);  // what it starts ends with it
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(kNotStarted);  // the parent has ended meanwhile
    ::setrlimit(RLIMIT_DATA, &memory);
    ::dup2(stdin_fd, STDIN_FILENO);
    ::dup2(stdin_fd, STDOUT_FILENO);
    ::dup2(stderr_fd, STDERR_FILENO);
    ::execve(words[0], words, environment);
    ::_exit(kNotStarted);
  }
};

}  // namespace

Child::Child(const std::vector<std::string>& words, const Variables& variables,
             const std::filesystem::path& stderr_file, const ChildLimits& limits)
    : seconds_(limits.seconds), start_(std::chrono::steady_clock::now()) {
  std::vector<std::string> texts = words, environment = environment_with(variables);
  const std::vector<char*> word_list = pointers(texts), environment_list = pointers(environment);
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  const int log = ::open(stderr_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  const int open_error = errno;
  if (log >= 0 && null >= 0) {
    const rlim_t bytes = static_cast<rlim_t>(limits.megabytes) * 1'000'000;
    const Start start{::getpid(),
                      null,
                      log,
                      {bytes, bytes},
                      const_cast<char**>(word_list.data()),
                      const_cast<char**>(environment_list.data())};
    pid_ = ::fork();
    if (pid_ == 0) start.run();
  }
  const int fork_error = errno;
  if (null >= 0) ::close(null);
  if (log >= 0) ::close(log);
  if (log < 0 || null < 0) fail_with_errno(stderr_file.string() + ": cannot be written", open_error);
  if (pid_ < 0) fail_with_errno(words[0] + ": no process can be started", fork_error);
  // glibc 2.36 declares pidfd_open() for C alone. Without it the end is noticed a little later.
  descriptor_ = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));
}

Child::Child(Child&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      seconds_(other.seconds_),
      start_(other.start_),
      out_of_time_(other.out_of_time_) {}

Child::~Child() {
  if (pid_ > 0) {
    kill();
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Child::kill() const {
  ::kill(-pid_, SIGKILL);
  ::kill(pid_, SIGKILL);  // where it has not made its group yet
}

std::optional<ChildEnd> Child::poll() {
  int status = 0;
  rusage used{};
  const pid_t ended = ::wait4(pid_, &status, WNOHANG, &used);
  ChildEnd end;
  end.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (ended != pid_) {
    if (end.seconds > seconds_ && !out_of_time_) {
      out_of_time_ = true;
      kill();
    }
    return std::nullopt;
  }
  ::kill(-pid_, SIGKILL);  // what it started and left
  pid_ = -1;
  end.out_of_time = out_of_time_;
  if (WIFEXITED(status)) end.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  end.cpu_s = seconds_of(used.ru_utime) + seconds_of(used.ru_stime);
  end.peak_mb = static_cast<double>(used.ru_maxrss) * 1024 / 1e6;
  return end;
}

}  // namespace hotblade::pipeline::batch
