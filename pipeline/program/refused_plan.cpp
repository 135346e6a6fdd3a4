#include "pipeline/program/refused_plan.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "pipeline/program/gzip.hpp"
#include "pipeline/program/json_node.hpp"
#include "pipeline/program/program_text.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_text.hpp"

namespace hotblade::pipeline {

namespace {

using Json = nlohmann::ordered_json;

// The program stands last, so that its own layout, which is read fast, is left as it is.
constexpr std::string_view kFound = ",\n\"found\": ", kEnd = "}\n";

std::string head_of(const std::vector<RefusedReason>& reasons) {
  Json list = Json::array();
  for (const RefusedReason& reason : reasons) {
    const bool known = reason.at && reason.at->allFinite();
    list.push_back({{"message", reason.message},
                    {"at", known ? Json{reason.at->x(), reason.at->y(), reason.at->z()} : Json()}});
  }
  return "{\"format\": \"" + std::string(kRefusedPlanFormat) +
         "\",\n\"version\": 1,\n\"reasons\": " + json_text(list);
}

// Where a limit broke, a strip may be no valid part of a program.
bool readable(const std::string& found) {
  try {
    (void)parse_program(found, "refused.json", 0);
    return true;
  } catch (const Error&) {
    return false;
  }
}

std::string found_text(const Program& program) {
  try {
    std::string text = to_json(program);
    if (program.strips.empty() || readable(text)) return text;
  } catch (const std::logic_error&) {  // a number that is not finite
  }
  Program bare = program;
  bare.strips.clear();
  return to_json(bare);
}

}  // namespace

std::string to_json(const RefusedPlan& plan) {
  std::string found = found_text(plan.found);
  while (found.ends_with('\n')) found.pop_back();
  return head_of(plan.reasons) + std::string(kFound) + found + std::string(kEnd);
}

bool is_refused_plan(const std::filesystem::path& file) {
  std::error_code ignored;
  if (is_gzip_name(file) && !std::filesystem::exists(file, ignored)) return false;
  const std::string beginning = "{\"format\": \"" + std::string(kRefusedPlanFormat) + "\"";
  if (is_gzip_name(file)) return file_text(file).starts_with(beginning);
  std::ifstream stream(file, std::ios::binary);
  std::string read(beginning.size(), '\0');
  return stream.read(read.data(), static_cast<std::streamsize>(read.size())) && read == beginning;
}

RefusedPlan read_refused_plan(const std::filesystem::path& file) {
  const std::string text = file_text(file), name = file.string();
  const std::size_t found = text.find(kFound);
  if (!is_refused_plan(file) || found == std::string::npos || !text.ends_with(kEnd))
    throw Error(ErrorKind::kBadInput, name + ": is not a refused plan, or not whole: plan again");
  const Json head = parse_json(text.substr(0, found) + "}", name);
  const JsonNode root(head, name), version = root.field("version"), reasons = root.field("reasons");
  if (version.count() != 1) version.fail("unknown version: use the hotblade that wrote it");
  RefusedPlan plan;
  for (std::size_t i = 0; i < reasons.items(1); ++i) {
    const JsonNode reason = reasons.item(i), at = reason.field("at");
    RefusedReason& read = plan.reasons.emplace_back();
    read.message = reason.field("message").text();
    if (at.is_null()) continue;
    (void)at.items(3, true);
    read.at = Eigen::Vector3d(at.item(0).number(), at.item(1).number(), at.item(2).number());
  }
  const std::size_t begin = found + kFound.size();
  plan.found = parse_program(text.substr(begin, text.size() - kEnd.size() - begin), name, 0);
  return plan;
}

}  // namespace hotblade::pipeline
