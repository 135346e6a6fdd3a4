#include "pipeline/batch/index_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>

#include "pipeline/batch/html_text.hpp"
#include "pipeline/batch/result.hpp"

namespace hotblade::pipeline::batch {
namespace {

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<style>
body{font:14px/1.4 system-ui,sans-serif;margin:1.5em;color:#1b1f23;background:#fff}
h1{font-size:1.4em;margin:0 0 .6em}
dl{display:flex;flex-wrap:wrap;gap:.4em 2em;margin:0 0 1em}
dt{color:#57606a}dd{margin:0;font-size:1.25em;font-variant-numeric:tabular-nums}
form{margin:0 0 1em;display:flex;gap:.6em;flex-wrap:wrap}
input,select{font:inherit;padding:.25em .4em}
table{border-collapse:collapse;width:100%}
th,td{padding:.25em .6em;text-align:left;border-bottom:1px solid #d8dee4;vertical-align:top}
th{position:sticky;top:0;background:#f6f8fa}
th button{font:inherit;font-weight:600;border:0;background:none;padding:0;cursor:pointer;color:inherit}
th[aria-sort=ascending] button::after{content:" \25B2"}th[aria-sort=descending] button::after{content:" \25BC"}
td.n,th.n{text-align:right}td.n{font-variant-numeric:tabular-nums;white-space:nowrap}
td img{display:block;width:160px;height:90px;background:#f6f8fa}
.passed{color:#1a7f37}.amber{color:#8a5300;font-weight:600}.refused,.over,.bad,.failed{color:#b3261e;font-weight:600}.missing{color:#57606a}
small{display:block;color:#57606a;max-width:40em;overflow-wrap:anywhere}
@media print{form{display:none}th{position:static}}
</style>
)";

// Sorts by the values of a column (numbers as numbers, what is empty last) and shows the rows that hold every
// word. Only some rows are in the table at a time: a browser lays ten thousand out in seconds. Without the
// script all of them are.
constexpr const char* kScript = R"(<script>
"use strict";
(function () {
  const step = 300;
  const table = document.querySelector("table"), body = table.tBodies[0];
  const heads = Array.from(table.tHead.rows[0].cells);
  const words = document.getElementById("words"), verdict = document.getElementById("verdict");
  const shown = document.getElementById("shown"), more = document.getElementById("more");
  let most = step;
  let rows = Array.from(body.rows).map(function (row) {
    return {row: row, text: row.textContent.toLowerCase(), verdict: row.dataset.v, color: row.dataset.c};
  });
  function value(row, column) {
    const cell = row.cells[column];
    const text = cell.dataset.s !== undefined ? cell.dataset.s : cell.textContent;
    return cell.className === "n" ? (text === "" ? NaN : Number(text)) : text;
  }
  function draw() {
    const wanted = words.value.toLowerCase().split(/\s+/).filter(Boolean);
    const kept = rows.filter(function (one) {
      return (verdict.value === "" || one.verdict === verdict.value || one.color === verdict.value) &&
        wanted.every(function (word) { return one.text.includes(word); });
    });
    const some = document.createDocumentFragment();
    kept.slice(0, most).forEach(function (one) { some.appendChild(one.row); });
    body.replaceChildren(some);
    shown.textContent = kept.length + " of " + rows.length + " jobs";
    more.hidden = kept.length <= most;
  }
  function sort(column, up) {
    const empty = function (key) { return key === "" || key !== key; };
    rows.forEach(function (one) { one.key = value(one.row, column); });
    rows.sort(function (a, b) {
      if (empty(a.key) || empty(b.key)) return empty(a.key) - empty(b.key);
      const order = a.key < b.key ? -1 : a.key > b.key ? 1 : 0;
      return up ? order : -order;
    });
    heads.forEach(function (head, i) {
      if (i === column) head.setAttribute("aria-sort", up ? "ascending" : "descending");
      else head.removeAttribute("aria-sort");
    });
    draw();
  }
  function show(count) {
    most = count;
    draw();
  }
  heads.forEach(function (head, column) {
    const button = head.querySelector("button");
    if (button) button.addEventListener("click", function () {
      sort(column, head.getAttribute("aria-sort") !== "ascending");
    });
  });
  words.addEventListener("input", function () { show(step); });
  verdict.addEventListener("change", function () { show(step); });
  more.addEventListener("click", function () { show(most + step); });
  window.addEventListener("beforeprint", function () { show(rows.length); });
  document.querySelector("form").addEventListener("submit", function (event) { event.preventDefault(); });
  draw();
}());
</script>
)";

double value_of(const PlanFacts& facts, const std::string& column) {
  const Cell& cell = facts.cells[plan_column(column)];
  return cell.number ? std::strtod(cell.text.c_str(), nullptr) : 0;
}

const std::string& verdict_in(const PlanFacts& facts) {
  static const std::size_t column = plan_column("verdict");
  return facts.cells[column].text;
}

// Of a plan that passed, and that its error budget takes over the tolerance.
bool is_amber(const PlanFacts& facts) {
  static const std::size_t column = plan_column("color");
  return facts.cells[column].text == kAmber && verdict_in(facts) == kPassed;
}

// What has to be looked at comes first.
int rank(const std::string& verdict) {
  constexpr std::array kOrder{"failed", "bad input", "refused", "over tolerance", "missing"};
  return static_cast<int>(std::find(kOrder.begin(), kOrder.end(), verdict) - kOrder.begin());
}

// A column of the page: its heading, the column of the table, and how many digits are shown.
struct Shown {
  const char *heading, *column;
  int digits;
};
constexpr std::array kShown{Shown{"deviation mm", "deviation_max_mm", 3},
                            Shown{"tolerance mm", "tolerance_mm", 2},
                            Shown{"blocks", "strips", 0},
                            Shown{"machine min", "machine_s", 1},
                            Shown{"foam m³", "stock_m3", 3},
                            Shown{"margin mm", "margin_mm_min", 2},
                            Shown{"plan s", "cpu_s", 2}};
constexpr double kSecondsPerMinute = 60;

std::string number_cell(const Cell& cell, const Shown& shown) {
  if (!cell.number) return "<td class=\"n\"></td>";
  double value = std::strtod(cell.text.c_str(), nullptr);
  if (shown.column == std::string("machine_s")) value /= kSecondsPerMinute;
  return fmt::format("<td class=\"n\">{:.{}f}</td>", value, shown.digits);
}

std::string row_text(const JobTable& table, const JobFacts& row) {
  const PlanFacts& facts = *row.facts;
  const std::string& verdict = verdict_in(facts);
  const std::string& message = facts.cells[plan_column("message")].text;
  const bool amber = is_amber(facts);
  std::string text = fmt::format("<tr data-v=\"{}\"{}><td class=\"n\">{}</td><td>", verdict,
                                 amber ? " data-c=\"amber\"" : "", row.job->number);
  if (!facts.picture.empty())
    text += fmt::format("<img loading=\"lazy\" width=\"160\" height=\"90\" alt=\"\" src=\"{}\">",
                        html_text(facts.picture));
  const std::string panel = html_text(row.job->panel);
  text += "</td><td>";
  text += facts.page.empty() ? panel : fmt::format("<a href=\"{}\">{}</a>", html_text(facts.page), panel);
  const std::string shown_verdict = amber ? verdict + ", amber" : verdict;
  text += fmt::format("</td><td data-s=\"{}\"><span class=\"{}\">{}</span>", shown_verdict,
                      amber ? kAmber : verdict.substr(0, verdict.find(' ')), shown_verdict);
  if (!message.empty()) text += "<small>" + html_text(message) + "</small>";
  text += "</td>";
  for (std::size_t i = 0; i < table.keys.size(); ++i) {
    const std::string& value = row.job->values[i];
    char* end = nullptr;
    (void)std::strtod(value.c_str(), &end);
    const bool number = !value.empty() && *end == '\0';
    text += fmt::format("<td{}>{}</td>", number ? " class=\"n\"" : "", html_text(value));
  }
  for (const Shown& shown : kShown) text += number_cell(facts.cells[plan_column(shown.column)], shown);
  return text + "</tr>\n";
}

// Sums over all jobs; processor time over plans, which several jobs may share.
std::string totals(const std::vector<JobFacts>& rows) {
  std::map<int, std::pair<std::string, std::size_t>> verdicts;
  double blocks = 0, foam_m3 = 0, machine_s = 0, cpu_s = 0;
  std::set<const PlanFacts*> counted;
  std::size_t amber = 0;
  for (const JobFacts& row : rows) {
    const std::string& verdict = verdict_in(*row.facts);
    auto& [name, count] = verdicts[rank(verdict)];
    name = verdict;
    ++count;
    if (counted.insert(row.facts).second) cpu_s += value_of(*row.facts, "cpu_s");
    if (verdict != kPassed) continue;  // nothing is cut
    amber += is_amber(*row.facts) ? 1U : 0U;
    blocks += value_of(*row.facts, "strips");
    foam_m3 += value_of(*row.facts, "stock_m3");
    machine_s += value_of(*row.facts, "machine_s");
  }
  std::string text = fmt::format("<dl>\n<div><dt>jobs</dt><dd>{}</dd></div>\n", rows.size());
  for (const auto& [order, verdict] : verdicts) {
    text += fmt::format("<div><dt>{0}</dt><dd class=\"{1}\">{2}</dd></div>\n", verdict.first,
                        verdict.first.substr(0, verdict.first.find(' ')), verdict.second);
  }
  if (amber > 0) text += fmt::format("<div><dt>of them amber</dt><dd class=\"amber\">{}</dd></div>\n", amber);
  constexpr double kSecondsPerHour = 3600;
  return text + fmt::format(
                    "<div><dt>blocks of passed jobs</dt><dd>{:.0f}</dd></div>\n"
                    "<div><dt>their foam</dt><dd>{:.2f} m³</dd></div>\n"
                    "<div><dt>their machine time</dt><dd>{:.2f} h</dd></div>\n"
                    "<div><dt>processor time</dt><dd>{:.2f} h</dd></div>\n</dl>\n",
                    blocks, foam_m3, machine_s / kSecondsPerHour, cpu_s / kSecondsPerHour);
}

std::string heading(const std::string& text, bool number) {
  return fmt::format("<th scope=\"col\"{}><button type=\"button\">{}</button></th>",
                     number ? " class=\"n\"" : "", html_text(text));
}

std::string controls(const std::vector<JobFacts>& rows) {
  std::map<int, std::string> verdicts;
  for (const JobFacts& row : rows) verdicts[rank(verdict_in(*row.facts))] = verdict_in(*row.facts);
  std::string text =
      "<form><label>words <input id=\"words\" type=\"search\"></label>\n<label>verdict <select "
      "id=\"verdict\">"
      "<option value=\"\">all</option>";
  for (const auto& [order, verdict] : verdicts) text += "<option>" + verdict + "</option>";
  if (std::any_of(rows.begin(), rows.end(), [](const JobFacts& row) { return is_amber(*row.facts); }))
    text += "<option>amber</option>";
  return text + fmt::format("</select></label> <output id=\"shown\">{} jobs</output></form>\n", rows.size());
}

}  // namespace

std::string index_page(const std::string& name, const JobTable& table, const std::vector<JobFacts>& rows) {
  std::vector<JobFacts> ordered = rows;
  std::stable_sort(ordered.begin(), ordered.end(), [](const JobFacts& a, const JobFacts& b) {
    const auto order = [](const PlanFacts& facts) {
      return std::pair(rank(verdict_in(facts)), is_amber(facts) ? 0 : 1);
    };
    return order(*a.facts) < order(*b.facts);
  });
  std::string text = kHead;
  text += "<title>" + html_text(name) + "</title></head>\n<body>\n<h1>" + html_text(name) + "</h1>\n" +
          totals(rows) + "<p><a href=\"cut_list.html\">Foam, blades and order of cutting</a></p>\n";
  text += controls(rows) + "<table><thead><tr>" + heading("job", true) + "<th scope=\"col\">cut</th>" +
          heading("panel", false) + heading("verdict", false);
  for (const std::string& key : table.keys) text += heading(key, false);
  for (const Shown& shown : kShown) text += heading(shown.heading, true);
  text += "</tr></thead>\n<tbody>\n";
  for (const JobFacts& row : ordered) text += row_text(table, row);
  return text + "</tbody></table>\n<button type=\"button\" id=\"more\" hidden>more</button>\n" + kScript +
         "</body></html>\n";
}

}  // namespace hotblade::pipeline::batch
