#include "robot/wire/job.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <new>

namespace hotblade::robot {
namespace {

EVP_MD_CTX* context_of(void* context) {
  return static_cast<EVP_MD_CTX*>(context);
}

// SHA-256 of two pieces, with a context that was made for it and is used again and again.
Sha256 digest(EVP_MD_CTX* context, std::span<const std::uint8_t> head, std::span<const std::uint8_t> tail) {
  Sha256 result{};
  unsigned int size = 0;
  const bool ok = EVP_DigestInit_ex(context, nullptr, nullptr) == 1 &&
                  EVP_DigestUpdate(context, head.data(), head.size()) == 1 &&
                  EVP_DigestUpdate(context, tail.data(), tail.size()) == 1 &&
                  EVP_DigestFinal_ex(context, result.data(), &size) == 1;
  if (!ok) throw std::bad_alloc();  // the only way SHA-256 can fail
  return result;
}

// Looking the algorithm up takes OpenSSL longer than hashing a waypoint: once.
EVP_MD_CTX* new_context() {
  EVP_MD_CTX* context = EVP_MD_CTX_new();
  if (context == nullptr || EVP_DigestInit_ex(context, EVP_sha256(), nullptr) != 1) throw std::bad_alloc();
  return context;
}

std::array<std::uint8_t, 8> big_endian(std::uint64_t value) {
  std::array<std::uint8_t, 8> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(value >> (56 - 8 * i));
  return bytes;
}

}  // namespace

Sha256 sha256(std::span<const std::uint8_t> bytes) {
  EVP_MD_CTX* context = new_context();
  const Sha256 result = digest(context, bytes, {});
  EVP_MD_CTX_free(context);
  return result;
}

std::string to_hex(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::string to_hex(std::uint64_t value) {
  return to_hex(big_endian(value));
}

Chain::Chain(std::uint64_t job_id) : context_(new_context()) {
  restart(job_id);
}

Chain::~Chain() {
  EVP_MD_CTX_free(context_of(context_));
}

void Chain::restart(std::uint64_t job_id) {
  const auto bytes = big_endian(job_id);
  value_ = {};
  std::copy(bytes.begin(), bytes.end(), value_.begin());
  first_ = true;
}

void Chain::resume(const Sha256& value) {
  value_ = value;
  first_ = false;
}

const Sha256& Chain::add(const protocol::RawWaypoint& raw) {
  constexpr std::size_t kSeedBytes = 8;
  const std::span<const std::uint8_t> before(value_);
  value_ = digest(context_of(context_), first_ ? before.first(kSeedBytes) : before, raw);
  first_ = false;
  return value_;
}

Job make_job(const Sha256& program_sha256, const std::string& strip, std::span<const Waypoint> waypoints,
             const ClampedBlade& blade) {
  if (waypoints.empty()) throw JobError("strip " + strip + ": no waypoints");
  if (!protocol::encode_blade(blade)) throw JobError("strip " + strip + ": blade does not fit the registers");
  Job job;
  job.strip = strip;
  job.blade = blade;
  job.raw.reserve(waypoints.size());
  for (const Waypoint& waypoint : waypoints) {
    const auto raw = protocol::encode_waypoint(waypoint);
    if (!raw) {
      throw JobError("strip " + strip + ": waypoint " + std::to_string(job.raw.size()) +
                     ": position or orientation does not fit the registers");
    }
    job.raw.push_back(*raw);
  }
  std::vector<std::uint8_t> bytes(program_sha256.begin(), program_sha256.end());
  bytes.insert(bytes.end(), strip.begin(), strip.end());
  for (const auto& raw : job.raw) bytes.insert(bytes.end(), raw.begin(), raw.end());
  const Sha256 hash = sha256(bytes);
  for (std::size_t i = 0; i < 8; ++i) job.id = job.id << 8 | hash[i];
  return job;
}

std::uint32_t prefix_crc(const Job& job, std::uint32_t count) {
  std::uint32_t crc = 0;
  for (std::uint32_t i = 0; i < count; ++i) crc = protocol::crc32(job.raw[i], crc);
  return crc;
}

}  // namespace hotblade::robot
