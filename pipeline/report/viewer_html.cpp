#include "pipeline/report/viewer_html.hpp"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "pipeline/report/page_texts.hpp"
#include "pipeline/settings/json_text.hpp"

namespace hotblade::pipeline {

namespace {

std::string view_buttons(const Words& w) {
  constexpr std::array<std::pair<char, const char*>, 4> kViewKeys{
      {{'i', "obliquely"}, {'t', "top"}, {'f', "front"}, {'s', "side"}}};
  std::string html = "<span role=\"group\" aria-label=\"" + w("view") + "\">";
  for (const auto& [key, name] : kViewKeys)
    html +=
        fmt::format("<button type=\"button\" data-view=\"{}\" title=\"{}\">{}</button>", key, key, w(name));
  return html + "</span>";
}

std::string layer_boxes(const Words& w) {
  constexpr std::array<std::pair<char, const char*>, 6> kLayerKeys{
      {{'d', "design"}, {'c', "cut"}, {'r', "ribs"}, {'b', "blocks"}, {'g', "ghosts"}, {'n', "names"}}};
  std::string html = "<span role=\"group\" aria-label=\"" + w("layers") + "\">";
  for (const auto& [key, name] : kLayerKeys) {
    html +=
        fmt::format("<label title=\"{}\"><input type=\"checkbox\" checked data-part=\"layer-{}\">{}</label> ",
                    key, name, w(name));
  }
  return html + "</span>";
}

constexpr const char* kKeys =
    "Drag turns, with shift or the right button it moves, the wheel zooms once the view has the focus; two "
    "fingers move and zoom. Keys: arrows turn, with shift move, + - zoom; t f s i views, 0 the first one; 1 "
    "to 5 colours; d c r b g n layers; , . one row back, forward, home end u the whole; x X clip plane; page "
    "up, "
    "page "
    "down strips, escape none. A click on a strip shows its card and marks its row.";

// What viewer.js says in the page's language, as JSON.
std::string words_json(const Words& w) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [english, other] : w.table()) json[std::string(english)] = other;
  // No "</" ends the script's element early.
  std::string text = json_text(json);
  for (std::size_t i = text.find("</"); i != std::string::npos; i = text.find("</", i))
    text.insert(i + 1, "\\");
  return text;
}

}  // namespace

std::string viewer_html(const ViewerScene& scene, const std::string& still, const Words& w) {
  std::string html =
      "<div id=\"view\" class=\"view\" data-state=\"still\"><div class=\"still\">" + still + "</div>\n";
  html +=
      "<div class=\"panel\"><div class=\"controls\">" + view_buttons(w) + "<label>" + w("colours") +
      " <select data-part=\"colour\"></select></label>" + layer_boxes(w) + "<span class=\"clip\"><label>" +
      w("clip") + " <select data-part=\"clip\"><option value=\"-1\">" + w("off") +
      "</option><option value=\"0\">x</option><option value=\"1\">y</option><option "
      "value=\"2\">z</option></select></label><input type=\"range\" min=\"0\" max=\"1000\" value=\"500\" "
      "aria-label=\"" +
      w("place of the clip plane") + "\" data-part=\"clip-at\"><button type=\"button\" data-part=\"flip\">" +
      w("other side") + "</button></span></div>\n";
  html += "<div class=\"stage\" data-part=\"stage\" tabindex=\"0\" role=\"application\" aria-label=\"" +
          w("the cut in three dimensions") +
          "\" aria-describedby=\"view-text\"><canvas data-part=\"canvas\"></canvas><div class=\"labels\" "
          "data-part=\"labels\"></div><div class=\"card\" data-part=\"card\" hidden></div></div>\n";
  html += "<label class=\"sweep\">" + w("sweep") +
          " <input type=\"range\" min=\"0\" max=\"0\" value=\"0\" data-part=\"sweep\"><output "
          "data-part=\"sweep-text\"></output></label><div class=\"key\" data-part=\"key\"></div></div>\n";
  html += "<p class=\"note\" id=\"view-text\" data-part=\"text\" aria-live=\"polite\"></p>";
  html += "<details class=\"panel\"><summary>" + w("keys") + "</summary><p class=\"note\">" + w(kKeys) +
          "</p></details>\n";
  html += "<script type=\"application/octet-stream\" id=\"view-scene\">" + scene.text + "</script>\n";
  html += "<script type=\"application/json\" id=\"view-words\">" + words_json(w) + "</script>\n";
  return html + "</div>\n";
}

}  // namespace hotblade::pipeline
