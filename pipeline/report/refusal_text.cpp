#include "pipeline/report/refusal_text.hpp"

#include <fmt/format.h>

namespace hotblade::pipeline {

std::string limit_text(const Refusal& r, const Words& w) {
  return w.said(info(r.limit).name) + w.said(r.when);
}

std::string unit(const Refusal& r, const Words& w) {
  return w.said(unit(r));
}

std::string note(const Refusal& r, const Words& w) {
  return w.said(note(r));
}

std::string describe_amount(const Refusal& r, const Words& w) {
  const std::string in_unit = unit(r).empty() ? "" : " " + unit(r, w);
  const AmountText amount = amount_text(r);
  return fmt::format("{} {}{}{} ({} {}{}){}", w.said(info(r.limit).name), r.capped ? ">= " : "", amount.value,
                     in_unit, w("limit"), amount.bound, in_unit, w.said(r.when));
}

std::string describe(const Refusal& r, const Words& w) {
  const std::string place = r.place.empty() ? "" : " " + w.said(r.place);
  const std::string said = note(r, w);
  return fmt::format("{}{}: {}{}", r.rib.empty() ? w.said(r.strip) : r.rib, place, describe_amount(r, w),
                     said.empty() ? "" : ": " + said);
}

}  // namespace hotblade::pipeline
