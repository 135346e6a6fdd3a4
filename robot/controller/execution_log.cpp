#include "robot/controller/execution_log.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

namespace hotblade::robot {
namespace {

// Lines are gathered up to this size before they are written; the longest line is far below the spare room.
constexpr std::size_t kFlushBytes = std::size_t{1} << 20;
constexpr std::size_t kSpareBytes = 4096;

void put(std::string& out, std::uint64_t value) {
  char text[24];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  out.append(text, end);
}

// Fixed decimals, no trailing zeros lost: lines stay comparable by eye.
void put(std::string& out, double value, int decimals) {
  char text[352];  // the longest double in fixed notation
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals).ptr;
  out.append(text, end);
}

void put_seconds(std::string& out, std::uint64_t us) {
  put(out, us / 1000000);
  char text[8] = ".000000";
  std::uint64_t rest = us % 1000000;
  for (int i = 6; i > 0; --i, rest /= 10) text[i] = static_cast<char>('0' + rest % 10);
  out.append(text, 7);
}

void put_hex(std::string& out, std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  for (const std::uint8_t byte : bytes) {
    out += kDigits[byte >> 4];
    out += kDigits[byte & 15];
  }
}

void put_hex(std::string& out, std::uint64_t value) {
  std::uint8_t bytes[8];
  for (int i = 0; i < 8; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (56 - 8 * i));
  put_hex(out, bytes);
}

// Decimals: 0.1 um for positions, 1e-9 for directions, both below the registers' resolution.
constexpr int kPositionDecimals = 4, kDirectionDecimals = 9, kTimeDecimals = 6;

void put_vector(std::string& out, const Eigen::Vector3d& v, int decimals) {
  out += '[';
  for (int i = 0; i < 3; ++i) {
    if (i > 0) out += ',';
    put(out, v[i], decimals);
  }
  out += ']';
}

void put_pose(std::string& out, const Pose& pose) {
  out += "{\"p\":";
  put_vector(out, pose.p, kPositionDecimals);
  out += ",\"q\":[";
  const std::array q{pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()};
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (i > 0) out += ',';
    put(out, q[i], kDirectionDecimals);
  }
  out += "]}";
}

// What a restarted controller has to know to go on.
void put_blade(std::string& out, const ClampedBlade& blade) {
  // It came through registers, so it fits them again.
  const protocol::BladeWords words = protocol::encode_blade(blade).value();
  for (std::size_t i = 0; i < words.size(); ++i) {
    out += ",\"";
    out += protocol::kBladeWordNames[i];
    out += "\":";
    put(out, words[i]);
  }
}

// The part of an arm as STATUS has it in its registers.
void put_arms_detail(std::string& out, const protocol::ArmsDetail& detail) {
  out += ",\"arm_fault\":[";
  put(out, detail.arm);
  out += ',';
  put(out, detail.part);
  out += ',';
  put(out, static_cast<std::uint8_t>(detail.other));
  out += ',';
  put(out, detail.other_part);
  out += ',';
  put(out, static_cast<double>(detail.amount), 0);
  out += ']';
}

// In whole microradians, as they came.
void put_arms(std::string& out, const protocol::Arms& arms) {
  out += ",\"cell\":\"";
  put_hex(out, arms.cell_id);
  out += '"';
  for (std::size_t clamp = 0; clamp < arms.joints_rad.size(); ++clamp) {
    out += clamp == 0 ? ",\"ja_urad\":[" : ",\"jb_urad\":[";
    for (std::size_t i = 0; i < protocol::kArmJoints; ++i) {
      if (i > 0) out += ',';
      put(out, std::round(arms.joints_rad[clamp][i] * 1e6), 0);
    }
    out += ']';
  }
}

void put_joints(std::string& out, const std::array<JointAngles, 2>& joints) {
  for (std::size_t clamp = 0; clamp < joints.size(); ++clamp) {
    out += clamp == 0 ? ",\"ja\":[" : ",\"jb\":[";
    for (int i = 0; i < joints[clamp].size(); ++i) {
      if (i > 0) out += ',';
      put(out, joints[clamp][i], kDirectionDecimals);
    }
    out += ']';
  }
}

// Twelve digits: a shape moves by less than 1e-6 mm by what is rounded away.
void put_digits(std::string& out, double value) {
  constexpr int kDigits = 12;
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, kDigits).ptr;
  out.append(text, end);
}

void put_margins(std::string& out, const std::optional<BladeMargins>& margins) {
  if (!margins) {
    out += "null";
    return;
  }
  out += "{\"margin\":";
  put(out, margins->margin, 4);
  out += ",\"curvature\":";
  put_digits(out, margins->curvature_per_mm);
  out += '}';
}

void put_shape(std::string& out, const std::optional<elastica::Elastica>& blade) {
  if (!blade) {
    out += "null";
    return;
  }
  out += "{\"x\":0,\"y\":0,\"theta\":0,\"kappa\":";
  put_digits(out, blade->kappa);
  out += ",\"lambda1\":";
  put_digits(out, blade->lambda1);
  out += ",\"lambda2\":";
  put_digits(out, blade->lambda2);
  out += ",\"length\":";
  put_digits(out, blade->length);
  out += '}';
}

// Cuts the file after its last complete line.
void drop_torn_line(int fd) {
  off_t size = ::lseek(fd, 0, SEEK_END);
  while (size > 0) {
    char last = 0;
    if (::pread(fd, &last, 1, size - 1) != 1 || last == '\n') break;
    --size;
  }
  if (::ftruncate(fd, size) == 0) ::lseek(fd, size, SEEK_SET);
}

}  // namespace

ExecutionLog::ExecutionLog(std::filesystem::path file, const Options& options)
    : file_(std::move(file)), options_(options) {
  fd_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0) {
    throw LogError(file_.string() + ": cannot be opened for appending (" + std::strerror(errno) +
                   "): choose a writable place");
  }
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    ::close(fd_);
    throw LogError(file_.string() +
                   ": is written by another controller: stop that one or choose another log");
  }
  drop_torn_line(fd_);
  buffer_.reserve(kFlushBytes + kSpareBytes);
}

ExecutionLog::~ExecutionLog() {
  commit();
  ::close(fd_);
}

void ExecutionLog::make_room() {
  if (buffer_.size() > kFlushBytes && error_ == 0) write_out();
}

void ExecutionLog::write_out() {
  std::size_t done = 0;
  error_ = 0;
  while (done < buffer_.size() && error_ == 0) {
    const ssize_t n = ::write(fd_, buffer_.data() + done, buffer_.size() - done);
    if (n > 0) {
      done += static_cast<std::size_t>(n);
    } else if (n < 0 && errno != EINTR) {
      error_ = errno;
    }
  }
  if (error_ != 0) return keep_from(done);
  buffer_.clear();
}

// Of a line that was written in part the file keeps nothing.
void ExecutionLog::keep_from(std::size_t written) {
  const std::size_t end = buffer_.rfind('\n', written - 1);
  const std::size_t whole = written == 0 || end == std::string::npos ? 0 : end + 1;
  const off_t size = ::lseek(fd_, 0, SEEK_CUR) - static_cast<off_t>(written - whole);
  const bool cut = written > whole && ::ftruncate(fd_, size) == 0 && ::lseek(fd_, size, SEEK_SET) == size;
  buffer_.erase(0, cut ? whole : written);
}

bool ExecutionLog::commit() {
  if (!unsynced_) write_out();
  if (error_ == 0 && options_.durable && dirty_) {
    while (::fdatasync(fd_) != 0 && errno != EINVAL) {
      if (errno == EINTR) continue;
      error_ = errno;
      unsynced_ = true;
      break;
    }
  }
  if (error_ == 0) dirty_ = false;
  tell();
  return error_ == 0;
}

void ExecutionLog::tell() {
  if (!options_.tell || (error_ == 0) == (told_ == 0)) return;
  told_ = error_;
  const std::string text = file_.string() + ": the log ";
  if (error_ == 0) return options_.tell(text + "is written again");
  options_.tell(text + "cannot be written (" + std::strerror(error_) + "): " +
                (unsynced_ ? "what it lacks may be lost: start again with another log"
                           : "make room, then reset the controller"));
}

void ExecutionLog::executed(const ExecutedWaypoint& w) {
  make_room();
  dirty_ = true;
  buffer_ += "{\"ev\":\"exec\",\"job\":\"";
  put_hex(buffer_, w.job);
  buffer_ += "\",\"token\":";
  put(buffer_, w.token);
  buffer_ += ",\"seq\":";
  put(buffer_, w.sequence);
  buffer_ += ",\"t_plan\":";
  put_seconds(buffer_, w.t_plan_us);
  buffer_ += ",\"t_exec\":";
  put_seconds(buffer_, w.t_exec_us);
  buffer_ += ",\"raw\":\"";
  put_hex(buffer_, w.raw);
  buffer_ += "\",\"margins\":";
  put_margins(buffer_, w.margins);
  buffer_ += ",\"chain\":\"";
  put_hex(buffer_, w.chain);
  buffer_ += "\"}\n";
}

void ExecutionLog::pose(const PoseSample& s) {
  if (!options_.poses) return;
  make_room();
  dirty_ = true;
  buffer_ += "{\"ev\":\"pose\",\"job\":\"";
  put_hex(buffer_, s.job);
  buffer_ += "\",\"seq\":";
  put(buffer_, s.sequence);
  buffer_ += ",\"t\":";
  put_seconds(buffer_, s.t_us);
  buffer_ += ",\"frame\":{\"origin\":";
  put_vector(buffer_, s.a.p, kPositionDecimals);
  buffer_ += ",\"x\":";
  put_vector(buffer_, s.a.q * Eigen::Vector3d::UnitX(), kDirectionDecimals);
  buffer_ += ",\"y\":";
  put_vector(buffer_, s.a.q * Eigen::Vector3d::UnitY(), kDirectionDecimals);
  buffer_ += "},\"a\":";
  put_pose(buffer_, s.a);
  buffer_ += ",\"b\":";
  put_pose(buffer_, s.b);
  buffer_ += ",\"blade\":";
  put_shape(buffer_, s.blade);
  buffer_ += ",\"heat\":";
  buffer_ += s.heat ? "true" : "false";
  buffer_ += ",\"state\":\"";
  buffer_ += protocol::name(s.state);
  buffer_ += "\",\"path\":";
  put(buffer_, s.path_s, kTimeDecimals);
  buffer_ += ",\"following_mm\":";
  put(buffer_, s.following_mm, kPositionDecimals);
  if (s.joints) put_joints(buffer_, *s.joints);
  buffer_ += "}\n";
}

void ExecutionLog::event(const JobEvent& e) {
  make_room();
  dirty_ = true;
  buffer_ += "{\"ev\":\"";
  buffer_ += e.what;
  buffer_ += "\",\"job\":\"";
  put_hex(buffer_, e.job);
  buffer_ += "\",\"run\":";
  put(buffer_, e.run);
  buffer_ += ",\"token\":";
  put(buffer_, e.token);
  buffer_ += ",\"executed\":";
  put(buffer_, e.sequence);
  buffer_ += ",\"planned\":";
  put(buffer_, e.waypoint_count);
  buffer_ += ",\"t\":";
  put_seconds(buffer_, e.t_us);
  buffer_ += ",\"fault\":\"";
  buffer_ += protocol::name(e.fault);
  buffer_ += "\",\"detail\":";
  put(buffer_, e.fault_detail);
  buffer_ += ",\"at\":";
  put(buffer_, e.fault_sequence);
  if (e.fault_arms != protocol::ArmsDetail{}) put_arms_detail(buffer_, e.fault_arms);
  if (std::strcmp(e.what, "open") == 0) put_blade(buffer_, e.blade);
  if (std::strcmp(e.what, "arms") == 0 && e.arms) put_arms(buffer_, *e.arms);
  buffer_ += "}\n";
}

}  // namespace hotblade::robot
