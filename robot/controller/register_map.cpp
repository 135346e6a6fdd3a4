#include "robot/controller/register_map.hpp"

#include <algorithm>

namespace hotblade::robot {
namespace {

constexpr std::uint8_t kOk = 0;

enum Function : std::uint8_t {
  kReadHolding = 3,
  kReadInput = 4,
  kWriteSingle = 6,
  kWriteMultiple = 16,
  kReadWrite = 23,
};

constexpr std::uint16_t kMaxRead = 125, kMaxWrite = 123, kMaxReadWriteWrite = 121;

std::uint16_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

// Whether count registers from address lie inside a block.
bool inside(std::uint16_t address, std::size_t count, std::uint16_t base, std::uint16_t size) {
  return address >= base && address + count <= std::size_t{base} + size;
}

template <typename Block>
Block sealed(Block block) {
  protocol::seal_block(block);
  return block;
}

}  // namespace

// One request under way: its bytes without the MBAP header, and the answer that grows.
struct RegisterMap::Pdu {
  std::span<const std::uint8_t> in;
  Reply& reply;
  Controller::Connection from;
  std::uint64_t now_us;

  void byte(unsigned value) { reply.bytes[reply.size++] = static_cast<std::uint8_t>(value); }
  void word(unsigned value) {
    byte(value >> 8);
    byte(value & 0xFF);
  }
};

Reply RegisterMap::handle(std::span<const std::uint8_t> request, Controller::Connection from,
                          std::uint64_t now_us) {
  controller_.heard(from, now_us);
  Reply reply;
  std::copy_n(request.begin(), kMbapSize, reply.bytes.begin());
  reply.size = kMbapSize;
  Pdu pdu{request.subspan(kMbapSize), reply, from, now_us};
  const std::uint8_t function = pdu.in[0], unit = request[kMbapSize - 1];
  pdu.byte(function);
  std::uint8_t exception = kIllegalFunction;
  if (unit != 1 && unit != 255) {
    exception = kNoSuchUnit;
  } else if (function == kReadHolding || function == kReadInput) {
    exception = read(pdu);
  } else if (function == kWriteSingle) {
    exception = write_single(pdu);
  } else if (function == kWriteMultiple) {
    exception = write_multiple(pdu);
  } else if (function == kReadWrite) {
    exception = read_write(pdu);
  }
  if (exception != kOk) {
    reply.size = kMbapSize;
    pdu.byte(function | 0x80u);
    pdu.byte(exception);
  }
  controller_.record_changes();
  const std::size_t length = reply.size - kMbapSize + 1;
  reply.bytes[4] = static_cast<std::uint8_t>(length >> 8);
  reply.bytes[5] = static_cast<std::uint8_t>(length & 0xFF);
  return reply;
}

std::uint8_t RegisterMap::read(Pdu& pdu) {
  if (pdu.in.size() != 5) return kIllegalValue;
  const std::uint16_t address = word_at(pdu.in, 1), count = word_at(pdu.in, 3);
  if (count < 1 || count > kMaxRead) return kIllegalValue;
  if (const auto refused = check_read(address, count); refused != kOk) return refused;
  return fill(pdu, address, count);
}

std::uint8_t RegisterMap::check_read(std::uint16_t address, std::uint16_t count) const {
  const bool known = inside(address, count, protocol::kIdentBase, protocol::kIdentSize) ||
                     inside(address, count, protocol::kStatusBase, protocol::kStatusSize) ||
                     inside(address, count, protocol::kScratchBase, protocol::kScratchSize);
  return known ? kOk : kIllegalAddress;
}

std::uint8_t RegisterMap::fill(Pdu& pdu, std::uint16_t address, std::uint16_t count) {
  controller_.record_changes();
  pdu.byte(2u * count);
  const auto copy = [&](const auto& block, std::uint16_t base) {
    for (std::size_t i = 0; i < count; ++i) pdu.word(block[address - base + i]);
  };
  if (address >= protocol::kScratchBase) {
    copy(scratch_, protocol::kScratchBase);
  } else if (address >= protocol::kStatusBase) {
    copy(sealed(protocol::encode_status(controller_.status())), protocol::kStatusBase);
  } else {
    copy(sealed(protocol::encode_ident(controller_.ident())), protocol::kIdentBase);
  }
  return kOk;
}

std::uint8_t RegisterMap::write_single(Pdu& pdu) {
  if (pdu.in.size() != 5) return kIllegalValue;
  const auto refused = write(pdu, word_at(pdu.in, 1), pdu.in.subspan(3, 2));
  if (refused == kOk) {
    for (std::size_t i = 1; i < 5; ++i) pdu.byte(pdu.in[i]);
  }
  return refused;
}

std::uint8_t RegisterMap::write_multiple(Pdu& pdu) {
  constexpr std::size_t kHead = 6;
  if (pdu.in.size() < kHead) return kIllegalValue;
  const std::uint16_t count = word_at(pdu.in, 3);
  if (count < 1 || count > kMaxWrite || pdu.in[5] != 2 * count || pdu.in.size() != kHead + 2u * count) {
    return kIllegalValue;
  }
  const auto refused = write(pdu, word_at(pdu.in, 1), pdu.in.subspan(kHead));
  if (refused == kOk) {
    for (std::size_t i = 1; i < 5; ++i) pdu.byte(pdu.in[i]);
  }
  return refused;
}

std::uint8_t RegisterMap::read_write(Pdu& pdu) {
  constexpr std::size_t kHead = 10;
  if (pdu.in.size() < kHead) return kIllegalValue;
  const std::uint16_t read_at = word_at(pdu.in, 1), read_count = word_at(pdu.in, 3);
  const std::uint16_t write_at = word_at(pdu.in, 5), write_count = word_at(pdu.in, 7);
  if (read_count < 1 || read_count > kMaxRead || write_count < 1 || write_count > kMaxReadWriteWrite ||
      pdu.in[9] != 2 * write_count || pdu.in.size() != kHead + 2u * write_count) {
    return kIllegalValue;
  }
  // Nothing is written when the answer could not be given.
  if (const auto refused = check_read(read_at, read_count); refused != kOk) return refused;
  if (const auto refused = write(pdu, write_at, pdu.in.subspan(kHead)); refused != kOk) return refused;
  return fill(pdu, read_at, read_count);
}

std::uint8_t RegisterMap::write(Pdu& pdu, std::uint16_t address, std::span<const std::uint8_t> data) {
  std::array<std::uint16_t, kMaxWrite> registers{};
  const std::size_t count = data.size() / 2;
  for (std::size_t i = 0; i < count; ++i) registers[i] = word_at(data, 2 * i);
  const auto words = std::span<const std::uint16_t>(registers).first(count);
  if (address == protocol::kCommandBase) return write_command(pdu, words);
  if (address == protocol::kWindowBase) return write_window(pdu, words);
  if (address == protocol::kArmsBase && controller_.options().arms) return write_arms(pdu, words);
  if (address == protocol::kEstopBase) {
    if (count != 1) return kIllegalValue;
    if (words[0] != 0) controller_.estop(pdu.now_us);
    return kOk;
  }
  if (inside(address, count, protocol::kScratchBase, protocol::kScratchSize)) {
    std::copy(words.begin(), words.end(), scratch_.begin() + (address - protocol::kScratchBase));
    return kOk;
  }
  return kIllegalAddress;
}

std::uint8_t RegisterMap::write_command(Pdu& pdu, std::span<const std::uint16_t> registers) {
  if (registers.size() != protocol::kCommandSize) return kIllegalValue;
  controller_.command(protocol::decode_command(registers.first<protocol::kCommandSize>()), pdu.from,
                      pdu.now_us);
  return kOk;
}

std::uint8_t RegisterMap::write_arms(Pdu& pdu, std::span<const std::uint16_t> registers) {
  if (registers.size() != protocol::kArmsSize) return kIllegalValue;
  controller_.arms(protocol::decode_arms(registers.first<protocol::kArmsSize>()), pdu.from, pdu.now_us);
  return kOk;
}

std::uint8_t RegisterMap::write_window(Pdu& pdu, std::span<const std::uint16_t> registers) {
  const auto window = protocol::decode_window(registers);
  if (!window) return kIllegalValue;
  controller_.window(*window, pdu.from, pdu.now_us);
  return kOk;
}

}  // namespace hotblade::robot
