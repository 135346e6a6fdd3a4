#include "pipeline/report/words.hpp"

#include <algorithm>
#include <stdexcept>

namespace hotblade::pipeline {

namespace {

constexpr std::pair<std::string_view, std::string_view> kGerman[] = {
    // sheets
    {"Job", "Auftrag"},
    {"Design", "Entwurf"},
    {"Date", "Datum"},
    {"Author", "Erstellt von"},
    {"Sheet", "Blatt"},
    {"of", "von"},
    {"Block", "Block"},
    {"Parts list", "Stückliste"},
    {"Assembly", "Zusammenbau"},
    {"order", "Folge"},
    {"block", "Block"},
    {"size as it stands: width x depth x height", "Maß, wie er steht: Breite x Tiefe x Höhe"},
    {"blade", "Klinge"},
    {"minutes", "Minuten"},
    {"foam", "Schaum"},
    {"its middle in the design x, y, z", "seine Mitte im Entwurf x, y, z"},
    {"its left front lower corner on the table x, y, z",
     "seine linke vordere untere Ecke auf dem Tisch x, y, z"},
    {"all", "alle"},
    {"blocks", "Blöcke"},
    {"Blade to mount", "Einzubauende Klinge"},
    {"free length", "freie Länge"},
    {"section", "Querschnitt"},
    {"clamp A on the left", "Klemme A links"},
    {"clamp A on the right", "Klemme A rechts"},
    {"Block size", "Blockmaß"},
    {"width, along the blade (x)", "Breite, entlang der Klinge (x)"},
    {"depth (y)", "Tiefe (y)"},
    {"height, along the cut (z)", "Höhe, entlang des Schnitts (z)"},
    {"Stands", "Steht"},
    {"on its face of", "auf der Fläche von"},
    {"above the table", "über dem Tisch"},
    {"Datum", "Bezug"},
    {"bottom edges, bold: left edge at x", "untere Kanten, fett: linke Kante bei x"},
    {"base face at y", "Grundfläche bei y"},
    {"underside at z", "Unterseite bei z"},
    {"from the middle of the table", "von der Tischmitte"},
    {"Base face", "Grundfläche"},
    {"at the front", "vorn"},
    {"at the back", "hinten"},
    {"write the block's name there, arrow up", "den Namen des Blocks dort anschreiben, Pfeil nach oben"},
    {"it stays whole", "sie bleibt ganz"},
    {"the blade comes through it at its ends", "die Klinge tritt an ihren Enden durch sie aus"},
    {"Blade enters", "Klinge tritt ein"},
    {"on top", "oben"},
    {"Blade leaves", "Klinge tritt aus"},
    {"below", "unten"},
    {"left end", "linkes Ende"},
    {"right end", "rechtes Ende"},
    {"on the left edge, from the base face", "an der linken Kante, ab Grundfläche"},
    {"on the right edge, from the base face", "an der rechten Kante, ab Grundfläche"},
    {"on the front edge, from the left edge", "an der vorderen Kante, ab der linken Kante"},
    {"on the back edge, from the left edge", "an der hinteren Kante, ab der linken Kante"},
    {"beside the block", "neben dem Block"},
    {"Part", "Teil"},
    {"the foam on the base face's side is the part, the rest is waste",
     "der Schaum auf der Seite der Grundfläche ist das Teil, der Rest ist Abfall"},
    {"Cut", "Schnitt"},
    {"number", "Nummer"},
    {"on the machine", "auf der Maschine"},
    {"Templates", "Schablonen"},
    {"Neighbours", "Nachbarn"},
    {"none", "keine"},
    {"Program", "Programm"},
    {"strip", "Streifen"},
    {"Cut by", "Geschnitten von"},
    {"Checked by", "Geprüft von"},
    {"Released by", "Freigegeben von"},
    {"date, signature", "Datum, Unterschrift"},
    {"seen from the front of the table, from above and the right",
     "von der Vorderseite des Tisches, von oben und rechts gesehen"},
    {"name on the back", "Name auf der Rückseite"},
    {"looking along", "Blick entlang"},
    {"an arrow points up as the block stood on the table",
     "ein Pfeil zeigt nach oben, wie der Block auf dem Tisch stand"},
    {"the blocks of this side in their places, seen from the waste side",
     "die Blöcke dieser Seite an ihrem Platz, von der Abfallseite gesehen"},
    {"all blocks in their places, seen from the waste side",
     "alle Blöcke an ihrem Platz, von der Abfallseite gesehen"},
    {"Blades", "Klingen"},
    {"Foam", "Schaum"},
    {"Cutting time", "Schnittzeit"},
    {"Not released: the plan was refused", "Nicht freigegeben: der Plan wurde abgelehnt"},
    {"Axes of a block size: width along the blade, depth towards the back of the table, height along the "
     "cut.",
     "Achsen eines Blockmaßes: Breite entlang der Klinge, Tiefe zur Rückseite des Tisches, Höhe entlang des "
     "Schnitts."},
};

}  // namespace

Words::Words(std::string_view language) : language_(language) {
  if (language != "en" && language != "de") throw std::logic_error("no words of this language");
}

std::string Words::operator()(std::string_view english) const {
  if (language_ == "en") return std::string(english);
  const auto found = std::find_if(std::begin(kGerman), std::end(kGerman),
                                  [&](const auto& pair) { return pair.first == english; });
  if (found == std::end(kGerman)) throw std::logic_error("no German for \"" + std::string(english) + "\"");
  return std::string(found->second);
}

std::span<const std::pair<std::string_view, std::string_view>> Words::table() const {
  if (language_ == "en") return {};
  return kGerman;
}

}  // namespace hotblade::pipeline
