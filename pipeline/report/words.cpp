#include "pipeline/report/words.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "pipeline/report/german.hpp"

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
    {"Foam to buy and to saw", "Schaum einkaufen und sägen"},
    {"To buy", "Einzukaufen"},
    {"used", "genutzt"},
    {"Every cut goes from face to face of its part, square to the edge named; it is measured from the end "
     "that keeps the part's letter, to the saw's near side.",
     "Jeder Schnitt geht von Fläche zu Fläche seines Stücks, quer zur genannten Kante; gemessen wird vom "
     "Ende, das den Buchstaben behält, bis zur nahen Seite der Säge."},
    {"part", "Stück"},
    {"square to its", "quer zur"},
    {"gives", "ergibt"},
    {"length", "Länge"},
    {"width", "Breite"},
    {"height", "Höhe"},
    {"order", "Folge"},
    {"block", "Block"},
    {"size as it stands: width x depth x height", "Maß, wie er steht: Breite x Tiefe x Höhe"},
    {"blade", "Klinge"},
    {"minutes", "Minuten"},
    {"foam", "Schaum"},
    {"its middle in the design x, y, z", "seine Mitte im Entwurf x, y, z"},
    {"its left front lower corner on the table x, y, z",
     "seine linke vordere untere Ecke auf dem Tisch x, y, z"},
    {"turned about it by", "um sie gedreht um"},
    {"counter-clockwise as seen from above", "gegen den Uhrzeigersinn, von oben gesehen"},
    {"clockwise as seen from above", "im Uhrzeigersinn, von oben gesehen"},
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
    {"Not released: the plan was refused", "Nicht freigegeben: der Plan wurde abgelehnt"},
    {"Axes of a block size: width along the blade, depth towards the back of the table, height along the "
     "cut.",
     "Achsen eines Blockmaßes: Breite entlang der Klinge, Tiefe zur Rückseite des Tisches, Höhe entlang "
     "des Schnitts."},
    // report.html: heading and verdict
    {"{:.1f} x {:.1f} x {:.1f} mm, {} faces, read in {}; foam kept: {}.",
     "{:.1f} x {:.1f} x {:.1f} mm, {} Flächen, gelesen in {}; Schaum bleibt: {}."},
    {"above", "oben"},
    {"back", "hinten"},
    {"front", "vorn"},
    {"SHA-256 of program.json", "SHA-256 von program.json"},
    {"Sheets for the floor", "Blätter für die Werkstatt"},
    {"one for each block", "eines für jeden Block"},
    {"passed", "bestanden"},
    {"refused", "abgelehnt"},
    {"Not cuttable as asked", "So nicht schneidbar"},
    {"Can be cut as planned", "Schneidbar wie geplant"},
    {"Can be cut, but not within {:g} mm for certain, however exact the clamps are",
     "Schneidbar, aber wie genau die Klemmen auch sind nicht sicher auf {:g} mm"},
    {"Can be cut within {:g} mm if the clamps are within {:g} mm and {:g} mrad",
     "Schneidbar auf {:g} mm, wenn die Klemmen auf {:g} mm und {:g} mrad genau sind"},
    {"Nothing is cut: no deviation could be measured.",
     "Nichts wird geschnitten: keine Abweichung konnte gemessen werden."},
    {"The surface the program cuts deviates from the design by at least <strong>{:.3f} mm</strong> "
     "(tolerance {:g} mm); worst at {}.",
     "Die Fläche, die das Programm schneidet, weicht vom Entwurf um mindestens <strong>{:.3f} mm</strong> "
     "ab (Toleranz {:g} mm); am meisten bei {}."},
    {"The largest deviation measured of the surface the program cuts is <strong>{:.3f} mm</strong>, and "
     "nowhere is it more than {:.3f} mm (tolerance {:g} mm); worst at {}.",
     "Die größte gemessene Abweichung der Fläche, die das Programm schneidet, ist <strong>{:.3f} "
     "mm</strong>, "
     "und nirgends ist sie mehr als {:.3f} mm (Toleranz {:g} mm); am meisten bei {}."},
    {"{:.2f} % of the design is left uncut.", "{:.2f} % des Entwurfs bleiben ungeschnitten."},
    {"Together with the errors of clamps, weight and mesh that no measurement of the plan can see, the "
     "error budget comes to <strong>{:.3f} mm</strong>, more than the tolerance; {:.3f} mm of it are the "
     "clamps', which may err by {:g} mm and {:g} mrad.",
     "Mit den Fehlern von Klemmen, Gewicht und Netz, die keine Messung des Plans sieht, kommt das "
     "Fehlerbudget auf <strong>{:.3f} mm</strong>, mehr als die Toleranz; {:.3f} mm davon sind die der "
     "Klemmen, die um {:g} mm und {:g} mrad falsch stehen dürfen."},
    {"Why it is refused", "Warum er abgelehnt ist"},
    {"where", "wo"},
    {"limit", "Grenze"},
    {"is", "ist"},
    {"allowed", "erlaubt"},
    {"note", "Anmerkung"},
    {"No other settings were found to pass. plan --advise tries more of them.",
     "Keine anderen Einstellungen bestanden. plan --advise versucht weitere."},
    {"What makes it cuttable", "Was ihn schneidbar macht"},
    {"with", "mit"},
    {"deviation", "Abweichung"},
    {"tolerance", "Toleranz"},
    {"strips", "Streifen"},
    {"verdict", "Urteil"},
    {"because", "weil"},
    {"Each was planned with all else as it is, and passed.",
     "Jede Änderung wurde geplant, alles andere unverändert, und bestand."},
    {"nothing is cut", "nichts wird geschnitten"},
    {"largest deviation", "größte Abweichung"},
    {"deviation of 99 % of the area", "Abweichung von 99 % der Fläche"},
    {"strips (blocks of foam)", "Streifen (Schaumblöcke)"},
    {"ribs, at most {:.3g} mm apart", "Rippen, höchstens {:.3g} mm auseinander"},
    {"time on the machine", "Zeit auf der Maschine"},
    {"foam in all blocks", "Schaum in allen Blöcken"},
    // its pictures and its view
    {"No pictures", "Keine Bilder"},
    {"not asked for (--no-pictures)", "nicht verlangt (--no-pictures)"},
    {"Pictures", "Bilder"},
    {"What is cut", "Was geschnitten wird"},
    {"on the cut side", "auf der geschnittenen Seite"},
    {"from above (+z)", "von oben (+z)"},
    {"from the front (-y)", "von vorn (-y)"},
    {"which block is which: colours by strip", "welcher Block welcher ist: Farben nach Streifen"},
    {"the design, on the cut side", "der Entwurf, auf der geschnittenen Seite"},
    {"the design, from above (+z)", "der Entwurf, von oben (+z)"},
    {"the design, from the front (-y)", "der Entwurf, von vorn (-y)"},
    {"view", "Ansicht"},
    {"obliquely", "schräg"},
    {"top", "oben"},
    {"side", "Seite"},
    {"layers", "Ebenen"},
    {"design", "Entwurf"},
    {"cut", "Schnitt"},
    {"ribs", "Rippen"},
    {"ghosts", "Klingen"},
    {"names", "Namen"},
    {"colours", "Farben"},
    {"clip", "Schnittebene"},
    {"off", "aus"},
    {"place of the clip plane", "Ort der Schnittebene"},
    {"other side", "andere Seite"},
    {"the cut in three dimensions", "der Schnitt in drei Dimensionen"},
    {"sweep", "Fahrt"},
    {"keys", "Tasten"},
    {"Drag turns, with shift or the right button it moves, the wheel zooms once the view has the focus; two "
     "fingers move and zoom. Keys: arrows turn, with shift move, + - zoom; t f s i views, 0 the first one; "
     "1 to 5 colours; d c r b g n layers; , . one row back, forward, home end u the whole; x X clip plane; "
     "page up, page down strips, escape none. A click on a strip shows its card and marks its row.",
     "Ziehen dreht, mit Umschalt oder der rechten Taste verschiebt es, das Rad zoomt, sobald die Ansicht "
     "den Fokus hat; zwei Finger verschieben und zoomen. Tasten: Pfeile drehen, mit Umschalt verschieben "
     "sie, + - zoomt; t f s i Ansichten, 0 die erste; 1 bis 5 Farben; d c r b g n Ebenen; , . eine Zeile "
     "zurück, vor, Pos1 Ende u das Ganze; x X Schnittebene; Bild auf, Bild ab Streifen, Esc keiner. Ein "
     "Klick auf einen Streifen zeigt seine Karte und markiert seine Zeile."},
    {"curvature", "Krümmung"},
    {"margin", "Reserve"},
    {"feed", "Vorschub"},
    {"deviation, mm", "Abweichung, mm"},
    {"curvature, % of yield", "Krümmung, % der Fließgrenze"},
    {"stability margin", "Stabilitätsreserve"},
    {"feed, mm/s", "Vorschub, mm/s"},
    {"Chosen", "Gewählt"},
    {"Clipped at", "Geschnitten bei"},
    {"Cut so far", "Bisher geschnitten"},
    {"One row of the cut in", "Eine Zeile des Schnitts von"},
    {"one point of a row in", "ein Punkt einer Zeile von"},
    {"Ringed", "Eingekreist"},
    {"Shown", "Gezeigt"},
    {"The design is drawn coarser than it is", "Der Entwurf ist gröber gezeichnet, als er ist"},
    {"The picture stands in for the view", "Das Bild steht für die Ansicht"},
    {"cut coloured by", "Schnitt gefärbt nach"},
    {"cut too deep", "zu tief geschnitten"},
    {"what stands in the way", "was im Weg steht"},
    {"foam left standing", "Schaum stehen geblieben"},
    {"show in the view", "in der Ansicht zeigen"},
    {"its row", "seine Zeile"},
    {"its sheet", "sein Blatt"},
    {"why", "warum"},
    {"the graphics context was lost", "der Grafikkontext ging verloren"},
    {"the whole cut", "der ganze Schnitt"},
    {"this browser has no WebGL 2", "dieser Browser hat kein WebGL 2"},
    {"this browser is too old", "dieser Browser ist zu alt"},
    {"triangles", "Dreiecke"},
    // its tables
    {"Strips", "Streifen"},
    {"nowhere over", "nirgends über"},
    {"rib fit at samples", "Anpassung der Rippen an Proben"},
    {"kink at seam", "Knick an der Naht"},
    {"plinth", "Sockel"},
    {"foam kept", "Schaum bleibt"},
    {"slowest feed", "langsamster Vorschub"},
    {"time", "Zeit"},
    {"smallest radius", "kleinster Radius"},
    {"straight", "gerade"},
    {"clamps may err", "erlaubter Fehler der Klemmen"},
    {"0.1 mm or 1 mrad moves", "0.1 mm oder 1 mrad verschiebt um"},
    {"{} over", "{} über der Grenze"},
    {"{:.2f} ({})", "{:.2f} ({})"},
    {"along a", "längs a"},
    {"across a", "quer a"},
    {"turn a", "Drehung a"},
    {"along b", "längs b"},
    {"across b", "quer b"},
    {"turn b", "Drehung b"},
    {"deg", "Grad"},
    {"clamp to foam", "Klemme zum Schaum"},
    {"end force", "Kraft am Ende"},
    {"end moment", "Moment am Ende"},
    {"bending stress", "Biegespannung"},
    {"of the allowed", "vom Erlaubten"},
    {"droop", "Durchhang"},
    {"Deviation: of the cut from the design within the strip; the largest of the page also counts the "
     "design from the cut. Nowhere over: what no place of the strip deviates more than, measured or not. "
     "Foam kept: the block's volume on the part's side of the blade; the rest is "
     "waste. Kink: the angle between the surfaces of neighbouring strips where they meet. Block: along the "
     "blade x towards the waste x along the sweep.",
     "Abweichung: des Schnitts vom Entwurf im Streifen; die größte der Seite zählt auch den Entwurf vom "
     "Schnitt. Nirgends über: mehr weicht kein Ort des Streifens ab, gemessen oder nicht. Schaum bleibt: das "
     "Volumen des Blocks auf der Seite des Teils; der Rest ist Abfall. Knick: "
     "der Winkel zwischen den Flächen benachbarter Streifen, wo sie sich treffen. Block: entlang der "
     "Klinge x zum Abfall hin x entlang der Fahrt."},
    {"Load on blade and clamps", "Last auf Klinge und Klemmen"},
    {"Largest of all poses. End force and moment are what a clamp has to hold. Allowed stress: {:.0f} MPa, "
     "the yield strength of {:.0f} MPa over a safety of {:g}. A stability margin of 0 is where the blade "
     "snaps into another shape.",
     "Das Größte aller Stellungen. Kraft und Moment am Ende sind, was eine Klemme halten muss. Erlaubte "
     "Spannung: {:.0f} MPa, die Fließgrenze von {:.0f} MPa durch eine Sicherheit von {:g}. Bei einer "
     "Stabilitätsreserve von 0 springt die Klinge in eine andere Form."},
    {"Which block goes where", "Welcher Block wohin gehört"},
    {"block as it stands, width x depth x height", "Block, wie er steht, Breite x Tiefe x Höhe"},
    {"Deviation", "Abweichung"},
    {"{} samples of the cut against the design, {} of the design against the cut.",
     "{} Messpunkte des Schnitts gegen den Entwurf, {} des Entwurfs gegen den Schnitt."},
    {"{} samples of the cut lie beyond the border or a crease of their face, in foam that is not the part.",
     "{} Messpunkte des Schnitts liegen jenseits des Randes oder einer Kante ihrer Fläche, in Schaum, der "
     "nicht zum Teil gehört."},
    {"{} samples of the cut lie beyond the design's border, in waste.",
     "{} Messpunkte des Schnitts liegen jenseits des Randes des Entwurfs, im Abfall."},
    {"share of the area", "Anteil der Fläche"},
    {"within, mm", "innerhalb, mm"},
    {"Deviation of both surfaces", "Abweichung beider Flächen"},
    {"no samples", "keine Messpunkte"},
    {"beyond", "darüber"},
    {"deviation, mm (cut to design and design to cut)",
     "Abweichung, mm (Schnitt zum Entwurf und Entwurf zum Schnitt)"},
    {"tolerance {:g} mm", "Toleranz {:g} mm"},
    {"Arms", "Arme"},
    {"Reach is the farthest wrist's, of what its arm reaches; least distances in mm.",
     "Reichweite: das fernste Handgelenk, von der seines Arms; kleinste Abstände in mm."},
    {"clamp A", "Klemme A"},
    {"clamp B", "Klemme B"},
    {"raised, mm", "angehoben, mm"},
    {"reach", "Reichweite"},
    {"joint margin", "Abstand zur Gelenkgrenze"},
    {"wrist", "Handgelenk"},
    {"added, s", "länger um, s"},
    {"nearest", "am nächsten"},
    {"arm to arm", "Arm zu Arm"},
    {"tool to block", "Werkzeug zu Block"},
    {"arm to block", "Arm zu Block"},
    {"arm to plinth", "Arm zu Sockel"},
    {"arm to table", "Arm zu Tisch"},
    {"arm to blade", "Arm zu Klinge"},
    {"arm to itself", "Arm zu sich selbst"},
    {"arm to obstacle", "Arm zu Hindernis"},
    {"blade to table", "Klinge zu Tisch"},
    {"blade to obstacle", "Klinge zu Hindernis"},
    {"block to obstacle", "Block zu Hindernis"},
    {"Error budget", "Fehlerbudget"},
    {"What each step of the chain may add, each measured on its own; the sum is the worst case, in which "
     "all add up. A measured deviation over the tolerance is refused; a sum over it makes the verdict amber.",
     "Was jeder Schritt der Kette hinzufügen darf, jeder für sich gemessen; die Summe ist der schlimmste "
     "Fall, in dem alle zusammenkommen. Eine gemessene Abweichung über der Toleranz wird abgelehnt; eine "
     "Summe darüber macht das Urteil gelb."},
    {"mesh", "Netz"},
    {"fit", "Anpassung"},
    {"joint fit", "gemeinsame Anpassung"},
    {"between ribs", "zwischen Rippen"},
    {"interpolation", "Interpolation"},
    {"quantisation", "Rundung"},
    {"gravity droop", "Durchhang"},
    {"gravity in plane", "Gewicht in der Ebene"},
    {"clamp error", "Fehler der Klemmen"},
    {"sum", "Summe"},
    {"Warnings", "Warnungen"},
    {"Refusals overridden", "Übergangene Ablehnungen"},
    {"Not checked", "Nicht geprüft"},
    {"Settings", "Einstellungen"},
    {"searched", "gesucht"},
    {"all faces", "alle Flächen"},
    // why a plan is as it is
    {"Why this plan", "Warum dieser Plan"},
    {"Faces", "Flächen"},
    {"The design has {} smooth faces that lie apart or meet in creases, which no strip follows far to both "
     "sides within the tolerance; each was planned as a design of its own.",
     "Der Entwurf hat {} glatte Flächen, die auseinanderliegen oder an Kanten zusammenstoßen, denen kein "
     "Streifen weit nach beiden Seiten innerhalb der Toleranz folgt; jede wurde wie ein eigener Entwurf "
     "geplant."},
    {"Direction", "Richtung"},
    {"Split", "Teilung"},
    {"Blade", "Klinge"},
    {"The shortest that clears the block, bends within yield and holds its shape, or a longer one where the "
     "clamps' errors would move that most; the next lengths of "
     "blade.free_lengths_mm come to this at the ribs, before weight is compensated:",
     "Die kürzeste, die vom Block frei bleibt, sich unter der Fließgrenze biegt und ihre Form hält, oder "
     "eine "
     "längere, wo die Fehler der Klemmen sie am meisten bewegen würden; mit "
     "den nächsten Längen von blade.free_lengths_mm kommt es an den Rippen, vor dem Ausgleich des "
     "Gewichts, dazu:"},
    {"the clamps' errors move it by {:.2f} mm instead of {:.2f} mm with {:.0f} mm",
     "die Fehler der Klemmen bewegen sie um {:.2f} mm statt um {:.2f} mm mit {:.0f} mm"},
    {"fitted with", "angepasst mit"},
    {"a shorter one", "eine kürzere"},
    {"a longer one", "eine längere"},
    {"The planes were given by slice.direction.", "Die Ebenen waren mit slice.direction vorgegeben."},
    {"The planes were given by slice.fan_axis.", "Die Ebenen waren mit slice.fan_axis vorgegeben."},
    {"one part", "ein Teil"},
    {"{} parts", "{} Teile"},
    {"its cheap fit is off by {:.2f} mm", "die grobe Anpassung weicht um {:.2f} mm ab"},
    {"no elastica follow its sections", "keine Elastika folgen ihren Schnitten"},
    {"elastica miss its sections by {:.2f} mm", "Elastika verfehlen ihre Schnitte um {:.2f} mm"},
    {"a fan about", "ein Fächer um"},
    {"planes with the normal", "Ebenen mit der Normalen"},
    {"{} ways to lay planes were ranked; of these: {}.",
     "{} Arten, die Ebenen zu legen, wurden verglichen; mit diesen: {}."},
    {"{} ways to lay planes were ranked by the strips that their rows of blocks take; of these: {}.",
     "{} Arten, die Ebenen zu legen, wurden nach den Streifen verglichen, die ihre Reihen von Blöcken "
     "brauchen; mit diesen: {}."},
    {"about {} strips", "etwa {} Streifen"},
    {"{:.1f} blocks or more, if none were wasted at the border",
     "{:.1f} Blöcke oder mehr, wenn am Rand keiner verloren ginge"},
    {"Its rows of blocks come to about {} strips; what fails in one is split again.",
     "Seine Reihen von Blöcken ergeben etwa {} Streifen; was in einer nicht geht, wird noch geteilt."},
    {"The best of the other directions, {}: {}.", "Die beste der anderen Richtungen, {}: {}."},
    {"Tried in full and refused, normal {}: {}.", "Ganz versucht und abgelehnt, Normale {}: {}."},
    {"{} instead of {} strips were tried and refused: {}.",
     "{} statt {} Streifen wurden versucht und abgelehnt: {}."},
    {"One strip does.", "Ein Streifen genügt."},
    {"No fewer can cut it: by its area and size it takes {} at least.",
     "Weniger gehen nicht: nach Fläche und Größe braucht er mindestens {}."},
    {"By its area and size {} would be the least.", "Nach Fläche und Größe wäre {} das Mindeste."},
    {"The best cheap fit of fewer parts: {}.", "Die beste grobe Anpassung von weniger Teilen: {}."},
    {"Of fewer than {} parts no layout had a cheap fit of them all.",
     "Von weniger als {} Teilen hatte keine Teilung eine grobe Anpassung aller Teile."},
    {"A strip takes {} on the machine and {:.1f} l of foam on average: about that is what one more would "
     "cost.",
     "Ein Streifen braucht im Mittel {} auf der Maschine und {:.1f} l Schaum: etwa das würde einer mehr "
     "kosten."},
    {"it does not hold its own weight", "sie trägt ihr eigenes Gewicht nicht"},
    {"weight moves the cut by {:.2f} mm", "das Gewicht verschiebt den Schnitt um {:.2f} mm"},
    {"the list has none", "die Liste hat keine"},
    {"turned by {:.0f} degrees from the plan's, which do not serve here",
     "um {:.0f} Grad gegen die des Plans gedreht, die hier nicht genügen"},
    {"{} ribs", "{} Rippen"},
    {"{} coefficients, {:.3f} mm off", "{} Koeffizienten, {:.3f} mm Abweichung"},
    {"{:g} times calmer", "{:g}-fach ruhiger"},
    // what was tried
    {"What was tried", "Was versucht wurde"},
    {"parts", "Teile"},
    {"planes", "Ebenen"},
    {"fit mm", "Anpassung mm"},
    {"deviation mm", "Abweichung mm"},
    {"found", "Ergebnis"},
    {"passes, taken", "besteht, genommen"},
    {"passes", "besteht"},
    {"of the whole", "des Ganzen"},
    {"rows of blocks", "Reihen von Blöcken"},
    {"strips by themselves", "Streifen jeder für sich"},
    {"split where the one before fails", "geteilt, wo der davor nicht genügt"},
    {"split where no strip serves, in the fewest parts",
     "geteilt, wo kein Streifen genügt, in die wenigsten Teile"},
    {"fitted together by what the one before found",
     "zusammen angepasst nach dem, was sich an dem davor fand"},
    {"with shorter blades where steadier ones fail",
     "mit kürzeren Klingen, wo ruhiger gehaltene nicht genügen"},
    {"calmer where the one before fails", "ruhiger, wo der davor nicht genügt"},
    {"all smooth faces together", "alle glatten Flächen zusammen"},
    {"face {}: {}", "Fläche {}: {}"},
    {"each face's own", "jede Fläche ihre eigenen"},
    {"planes turned on until the fit is nearer", "Ebenen weitergedreht, bis die Anpassung näher ist"},
    {"a fan, in the middle", "ein Fächer, in der Mitte"},
    {"Planes by their normals; slice.direction gives one, slice.fan_axis an axis.",
     "Ebenen nach ihren Normalen; slice.direction gibt eine vor, slice.fan_axis eine Achse."},
    {"{} earlier ones stand in report.json.", "{} frühere stehen in report.json."},
    {"Directions ranked", "Verglichene Richtungen"},
    {"parts along sweep x ribs", "Teile entlang Fahrt x Rippen"},
    {"missed by elastica, from Beziers mm", "von Elastika verfehlt, aus Bezierkurven mm"},
    {"cheap fit mm", "grobe Anpassung mm"},
    {"normal", "Normale"},
    {"turn about", "drehen um"},
    {"at", "bei"},
    {"The best are fitted closely and turned where they do not serve; slice.direction fixes the planes, "
     "slice.fan_axis an axis.",
     "Die besten werden genau angepasst und gedreht, wo sie nicht genügen; slice.direction legt die "
     "Ebenen fest, slice.fan_axis eine Achse."},
    {"{} more stand in report.json.", "{} weitere stehen in report.json."},
};

using Pair = std::pair<std::string_view, std::string_view>;

const Pair* found_in(std::span<const Pair> table, std::string_view english) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const Pair& pair) { return pair.first == english; });
  return found == table.end() ? nullptr : &*found;
}

// What stands between the places of a sentence, and whether a place takes numbers alone.
struct Pieces {
  std::vector<std::string_view> between{};
  std::vector<bool> numbers{};

  explicit Pieces(std::string_view text) {
    for (std::size_t place = text.find('{'); place != std::string_view::npos; place = text.find('{')) {
      const std::size_t end = text.find('}', place);
      between.push_back(text.substr(0, place));
      numbers.push_back(end > place + 1);
      text.remove_prefix(end + 1);
    }
    between.push_back(text);
  }

  // Whether this place stands in quotes, as a setting has its value.
  [[nodiscard]] bool quotes(std::size_t place) const {
    return between[place].ends_with('"') && between[place + 1].starts_with('"');
  }

  [[nodiscard]] std::size_t length() const {
    std::size_t sum = 0;
    for (const std::string_view piece : between) sum += piece.size();
    return sum;
  }
};

bool is_number(std::string_view text) {
  return !text.empty() && text.find_first_not_of("+-.0123456789einfa") == std::string_view::npos;
}

// Finds the values of a text's places from one of them on; false where it is another sentence.
bool find_values(const Pieces& sentence, std::size_t place, std::string_view text,
                 std::vector<std::string_view>& values) {
  if (place == sentence.numbers.size()) return text.empty();
  const std::string_view after = sentence.between[place + 1];
  const bool last = place + 1 == sentence.numbers.size();
  // The last place reaches to the end; another may end wherever what stands behind it does, at the last such
  // place first: of two sentences in one, the longer stands before what is said of it.
  std::size_t end = last ? (text.ends_with(after) ? text.size() - after.size() : std::string_view::npos)
                         : text.rfind(after);
  for (; end != std::string_view::npos && end > 0;
       end = last ? std::string_view::npos : text.rfind(after, end - 1)) {
    const std::string_view value = text.substr(0, end);
    if (sentence.numbers[place] && !is_number(value)) continue;
    values.push_back(value);
    if (find_values(sentence, place + 1, text.substr(end + after.size()), values)) return true;
    values.pop_back();
  }
  return false;
}

struct Sentence {
  Pieces english, other;
};

std::vector<Sentence> sentences_of(std::span<const Pair> words, std::span<const Pair> sentences) {
  std::vector<Sentence> all;
  for (const std::span<const Pair> table : {words, sentences}) {
    for (const auto& [english, other] : table) all.push_back({Pieces(english), Pieces(other)});
  }
  // Of two that a text may be, it is the one that says more.
  std::stable_sort(all.begin(), all.end(), [](const Sentence& a, const Sentence& b) {
    return a.english.length() > b.english.length();
  });
  return all;
}

const std::vector<Sentence>& german() {
  static const std::vector<Sentence> all = sentences_of(kGerman, german_sentences());
  return all;
}

}  // namespace

Words::Words(std::string_view language) : language_(language) {
  if (language != "en" && language != "de") throw std::logic_error("no words of this language");
}

std::string Words::operator()(std::string_view english) const {
  if (language_ == "en") return std::string(english);
  for (const std::span<const Pair> table : {std::span<const Pair>(kGerman), german_words_of_limits()}) {
    if (const Pair* found = found_in(table, english)) return std::string(found->second);
  }
  throw std::logic_error("no German for \"" + std::string(english) + "\"");
}

std::string Words::said(std::string_view english) const {
  if (language_ == "en") return std::string(english);
  for (const std::span<const Pair> table : {std::span<const Pair>(kGerman), german_words_of_limits()}) {
    if (const Pair* found = found_in(table, english)) return std::string(found->second);
  }
  for (const Sentence& sentence : german()) {
    const std::string_view first = sentence.english.between.front();
    if (!english.starts_with(first)) continue;
    std::vector<std::string_view> values;
    if (!find_values(sentence.english, 0, english.substr(first.size()), values)) continue;
    std::string text(sentence.other.between.front());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const bool as_it_is = sentence.english.numbers[i] || sentence.english.quotes(i);
      text += as_it_is ? std::string(values[i]) : said(values[i]);
      text += sentence.other.between[i + 1];
    }
    return text;
  }
  return std::string(english);
}

std::span<const std::pair<std::string_view, std::string_view>> Words::table() const {
  if (language_ == "en") return {};
  return kGerman;
}

}  // namespace hotblade::pipeline
