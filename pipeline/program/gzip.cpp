#include "pipeline/program/gzip.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <new>
#include <utility>

#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {
namespace {

// Of panels' programs level 4 makes 1/3.85 in 55 ms, level 6 1/3.93 in 114 ms, level 1 1/3.54 in 29 ms.
constexpr int kLevel = 4;
constexpr int kMemory = 8;                   // zlib's own choice
constexpr int kGzipWindow = MAX_WBITS + 16;  // the 16 asks for gzip's head and end
constexpr std::size_t kPiece = 1 << 16;

constexpr std::size_t kAlwaysTaken = std::size_t{64} << 20, kMostRatio = 200;

// zlib counts in 32 bits, and takes what it only reads as if it wrote it.
void give(z_stream& stream, std::string_view& rest) {
  const std::size_t piece = std::min<std::size_t>(rest.size(), std::numeric_limits<uInt>::max());
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(rest.data()));
  stream.avail_in = static_cast<uInt>(piece);
  rest.remove_prefix(piece);
}

class Unpacker {
 public:
  Unpacker(std::string_view bytes, const std::string& file_name)
      : rest_(bytes), file_(file_name), most_(std::max(kAlwaysTaken, kMostRatio * bytes.size())) {
    if (::inflateInit2(&stream_, kGzipWindow) != Z_OK) throw std::bad_alloc();
  }
  ~Unpacker() { ::inflateEnd(&stream_); }
  Unpacker(const Unpacker&) = delete;
  Unpacker& operator=(const Unpacker&) = delete;

  std::string text() {
    if (rest_.size() < 2 || rest_[0] != '\x1f' || rest_[1] != '\x8b')
      fail("is no gzip file: take .gz off its name, or write it again");
    // A member ends with its length; where there are several the text grows.
    if (rest_.size() > 4) {
      std::size_t length = 0;
      for (std::size_t i = 0; i < 4; ++i)
        length |= std::size_t{static_cast<unsigned char>(rest_[rest_.size() - 4 + i])} << (8 * i);
      text_.reserve(std::min(length, most_));
    }
    for (bool more = true; more;) more = unpack_member();
    return std::move(text_);
  }

 private:
  // Returns whether another member follows.
  bool unpack_member() {
    std::array<char, kPiece> piece;
    for (;;) {
      if (stream_.avail_in == 0) give(stream_, rest_);
      const bool out_of_bytes = stream_.avail_in == 0;
      stream_.next_out = reinterpret_cast<Bytef*>(piece.data());
      stream_.avail_out = static_cast<uInt>(piece.size());
      const int code = ::inflate(&stream_, Z_NO_FLUSH);
      text_.append(piece.data(), piece.size() - stream_.avail_out);
      if (text_.size() > most_)
        fail(fmt::format("unpacks to more than {} times its size: is no program", kMostRatio));
      if (code == Z_STREAM_END) break;
      if (code == Z_MEM_ERROR) throw std::bad_alloc();
      if (code == Z_BUF_ERROR && out_of_bytes) fail("is cut off (gzip): copy or write it again");
      if (code != Z_OK && code != Z_BUF_ERROR)
        fail(fmt::format("is damaged (gzip: {}): copy or write it again",
                         stream_.msg != nullptr ? stream_.msg : "wrong data"));
    }
    if (stream_.avail_in == 0) give(stream_, rest_);
    if (stream_.avail_in == 0) return false;
    if (stream_.next_in[0] != 0x1f) fail("goes on after its end (gzip): copy or write it again");
    ::inflateReset(&stream_);
    return true;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::kBadInput, file_ + ": " + what);
  }

  z_stream stream_{};
  std::string_view rest_;
  const std::string& file_;
  std::size_t most_;
  std::string text_;
};

}  // namespace

bool is_gzip_name(const std::filesystem::path& file) {
  return file.extension() == ".gz";
}

std::string unpacked(std::string_view bytes, const std::string& file_name) {
  return Unpacker(bytes, file_name).text();
}

std::string packed(std::string_view text) {
  z_stream stream{};
  if (::deflateInit2(&stream, kLevel, Z_DEFLATED, kGzipWindow, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  const std::unique_ptr<z_stream, decltype(&::deflateEnd)> end(&stream, &::deflateEnd);
  std::string bytes;
  std::array<char, kPiece> piece;
  for (int code = Z_OK; code != Z_STREAM_END;) {
    if (stream.avail_in == 0) give(stream, text);
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    code = ::deflate(&stream, text.empty() ? Z_FINISH : Z_NO_FLUSH);
    bytes.append(piece.data(), piece.size() - stream.avail_out);
  }
  return bytes;
}

}  // namespace hotblade::pipeline
