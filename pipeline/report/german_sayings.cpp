#include "pipeline/report/german.hpp"

namespace hotblade::pipeline {

namespace {

// Limits, their units, and words that stand in sentences.
constexpr std::pair<std::string_view, std::string_view> kWords[] = {
    {"no limit", "keine Grenze"},
    {"unknown limit", "unbekannte Grenze"},
    {"number of waypoints", "Zahl der Wegpunkte"},
    {"length of the quaternion", "Länge des Quaternions"},
    {"heat bits of the clamps", "Heizbits der Klemmen"},
    {"time of a waypoint", "Zeit eines Wegpunkts"},
    {"time between waypoints", "Zeit zwischen Wegpunkten"},
    {"half turn of the flat arc at the start", "halbe Drehung des flachen Bogens am Anfang"},
    {"distance outside the envelope", "Abstand jenseits des Arbeitsraums"},
    {"clamp speed", "Geschwindigkeit einer Klemme"},
    {"clamp acceleration", "Beschleunigung einer Klemme"},
    {"clamp angular speed", "Drehgeschwindigkeit einer Klemme"},
    {"clamp angular acceleration", "Drehbeschleunigung einer Klemme"},
    {"chord of the blade", "Sehne der Klinge"},
    {"blade data of the job", "Klingendaten des Auftrags"},
    {"distance of the path from the held pose", "Abstand der Bahn von der gehaltenen Stellung"},
    {"distance of clamp B from clamp A's plane", "Abstand der Klemme B von der Ebene der Klemme A"},
    {"distance between the clamps", "Abstand zwischen den Klemmen"},
    {"the blade is pulled taut", "die Klinge ist straff gezogen"},
    {"stability margin, the blade snaps through", "Stabilitätsreserve, die Klinge schlägt durch"},
    {"blade radius", "Radius der Klinge"},
    {"the blade would yield", "die Klinge würde sich bleibend verformen"},
    {"the blade could snap through", "die Klinge könnte durchschlagen"},
    {"distance of the declared joints from waypoint 0", "Abstand der angemeldeten Gelenke von Wegpunkt 0"},
    {"distance of an arm's wrist from its shoulder",
     "Abstand des Handgelenks eines Arms von seiner Schulter"},
    {"the arm does not reach so far", "so weit reicht der Arm nicht"},
    {"joint angle of an arm", "Gelenkwinkel eines Arms"},
    {"degrees", "Grad"},
    {"joint speed of an arm", "Gelenkgeschwindigkeit eines Arms"},
    {"joint acceleration of an arm", "Gelenkbeschleunigung eines Arms"},
    {"distance of an arm from singular", "Abstand eines Arms von der Singularität"},
    {"branch of an arm", "Zweig eines Arms"},
    {"clearance in the cell", "Abstand in der Zelle"},
    {"jerk of an arm", "Ruck eines Arms"},
    {"distance of the blade from the planned shape", "Abstand der Klinge von der geplanten Form"},
    {"the clamps lead the blade to another shape than the plan's",
     "die Klemmen führen die Klinge in eine andere Form als die des Plans"},
    {"lean of the surface towards z", "Neigung der Fläche gegen z"},
    {"design.keep says nothing about an upright surface",
     "design.keep sagt nichts über eine aufrechte Fläche"},
    {"side of the waste across the ribs", "Seite des Abfalls quer zu den Rippen"},
    {"face normals turn over along the ribs", "die Normalen der Flächen kehren sich entlang der Rippen um"},
    {"slope of the design against the rib planes", "Neigung des Entwurfs gegen die Rippenebenen"},
    {"no blade follows what is as steep", "so Steilem folgt keine Klinge"},
    {"turn of the design's normals within a rib plane",
     "Drehung der Normalen des Entwurfs in einer Rippenebene"},
    {"no blade forms what faces back", "was zurückschaut, formt keine Klinge"},
    {"gap in the design within a strip that keeps to one side",
     "Lücke im Entwurf in einem Streifen, der auf einer Seite bleibt"},
    {"no part of the design could be planned", "kein Teil des Entwurfs ließ sich planen"},
    {"deviation of an elastica", "Abweichung einer Elastika"},
    {"radius of a rib (bending stress over yield strength and safety)",
     "Radius einer Rippe (Biegespannung über Fließgrenze und Sicherheit)"},
    {"the design bends more sharply than the blade can",
     "der Entwurf ist schärfer gebogen, als die Klinge kann"},
    {"rib length", "Länge einer Rippe"},
    {"no blade is as long", "so lang ist keine Klinge"},
    {"block edge", "Blockkante"},
    {"no block is as large", "so groß ist kein Block"},
    {"clamp clearance to the stock", "Abstand einer Klemme zum Schaum"},
    {"depth of the blade's free part in the kept foam",
     "Tiefe des freien Teils der Klinge im Schaum, der bleibt"},
    {"self-crossings of the blade", "Selbstkreuzungen der Klinge"},
    {"stability margin (snap-through)", "Stabilitätsreserve (Durchschlagen)"},
    {"the blade could snap through on its way", "die Klinge könnte unterwegs durchschlagen"},
    {"sag of the blade under its weight", "Durchhang der Klinge unter ihrem Gewicht"},
    {"bending stress (yield strength over safety)", "Biegespannung (Fließgrenze durch Sicherheit)"},
    {"the blade would yield on its way", "die Klinge würde sich unterwegs bleibend verformen"},
    {"clamp error that makes the blade snap", "Fehler der Klemmen, der die Klinge durchschlagen lässt"},
    {"margin against tipping out of the plane", "Reserve gegen Kippen aus der Ebene"},
    {"duration", "Dauer"},
    {"registers hold no more", "mehr fassen die Register nicht"},
    {"clamp jerk", "Ruck einer Klemme"},
    {"clamp angular jerk", "Drehruck einer Klemme"},
    {"distance of the clamps from a common plane", "Abstand der Klemmen von einer gemeinsamen Ebene"},
    {"clamp height above the table", "Höhe einer Klemme über dem Tisch"},
    {"feed of the slowest blade point", "Vorschub des langsamsten Punkts der Klinge"},
    {"the blade would melt too wide there", "die Klinge würde dort zu breit schmelzen"},
    {"deviation with the sag of the blade under its weight",
     "Abweichung mit dem Durchhang der Klinge unter ihrem Gewicht"},
    {"uncut share of the area", "ungeschnittener Anteil der Fläche"},
    {"error budget", "Fehlerbudget"},
    {"angle between axes 4 and 6 of an arm", "Winkel zwischen den Achsen 4 und 6 eines Arms"},
    {"the arm is next to singular", "der Arm ist nahe an der Singularität"},
    {"angle of an arm's elbow from stretched", "Winkel des Ellbogens eines Arms gegen gestreckt"},
    {"distance of an arm's wrist from axis 1", "Abstand des Handgelenks eines Arms von Achse 1"},
    {"warnings with --strict", "Warnungen mit --strict"},
    {"green", "grün"},
    {"amber", "gelb"},
    {"red", "rot"},
    {"speed", "Geschwindigkeit"},
    {"angular speed", "Drehgeschwindigkeit"},
    {"acceleration", "Beschleunigung"},
    {"limit of jerk", "Ruckgrenze"},
    {"limit of angular jerk", "Drehruckgrenze"},
    {"angular acceleration", "Drehbeschleunigung"},
    {"clamp a", "Klemme a"},
    {"clamp b", "Klemme b"},
    {"the block", "der Block"},
    {"the plinth", "der Sockel"},
    {"the table", "der Tisch"},
    {"the blade", "die Klinge"},
    {"line", "Zeile"},
    {"facet", "Facette"},
    {"face", "Fläche"},
    {"triangle", "Dreieck"},
    {"form", "Formen"},
    {"preheat", "Vorheizen"},
    {"approach", "Anfahren"},
    {"lead_in", "Einfahren"},
    {"lead_out", "Ausfahren"},
    {"retract", "Zurückziehen"},
    {"travel", "Weg"},
};

constexpr std::pair<std::string_view, std::string_view> kSentences[] = {
    // of a refusal
    {" in phase {} at {:.2f} s", " in der Phase {} bei {:.2f} s"},
    {" before the strip begins", " bevor der Streifen beginnt"},
    {" from its Bezier", " von ihrer Bezierkurve"},
    {"at ({:.1f}, {:.1f}, {:.1f})", "bei ({:.1f}, {:.1f}, {:.1f})"},
    {"about ({:.1f}, {:.1f}, {:.1f})", "um ({:.1f}, {:.1f}, {:.1f})"},
    {", measured there {:.3f} mm", ", dort gemessen {:.3f} mm"},
    {"a Bezier may use up a tenth of the tolerance", "eine Bezierkurve darf ein Zehntel der Toleranz nutzen"},
    {"the blade turns there, its fastest point goes at {:.3g} mm/s, and it would melt too wide",
     "die Klinge dreht sich dort, ihr schnellster Punkt fährt {:.3g} mm/s, und sie würde zu breit "
     "schmelzen"},
    {"the blade turns there with its planes, its fastest point goes at {:.3g} mm/s, and it would melt too "
     "wide",
     "die Klinge dreht sich dort mit ihren Ebenen, ihr schnellster Punkt fährt {:.3g} mm/s, und sie würde "
     "zu breit schmelzen"},
    {"the blade turns there, its fastest point in foam, in the waste beside the design, goes at {:.3g} mm/s, "
     "and it would melt too wide: the smallest feed takes motion.feed_mm_s of {} mm/s",
     "die Klinge dreht sich dort, ihr schnellster Punkt im Schaum, im Abfall neben dem Entwurf, fährt "
     "{:.3g} mm/s, und sie würde zu breit schmelzen: der kleinste Vorschub braucht motion.feed_mm_s von {} "
     "mm/s"},
    {"the clamps' {} holds the blade back there, and it would melt too wide: the smallest feed takes {} of "
     "{} {}",
     "dort hält die Klemmen ihre {} zurück, und die Klinge würde zu breit schmelzen: der kleinste "
     "Vorschub braucht {} von {} {}"},
    {"motion.lead_mm ends nearer behind the block", "motion.lead_mm endet näher hinter dem Block"},
    {"design.keep = \"{}\" says nothing about an upright surface",
     "design.keep = \"{}\" sagt nichts über eine aufrechte Fläche"},
    {"the design is closed, and a blade cuts one side of it: design.facing says which, and check proposes "
     "one",
     "der Entwurf ist geschlossen, und eine Klinge schneidet nur eine Seite davon: design.facing sagt, "
     "welche; "
     "check schlägt eine vor"},
    {"is the design really in {}? Else plan it in parts",
     "ist der Entwurf wirklich in {}? Sonst in Teilen planen"},
    {"about ({:.1f}, {:.1f}, {:.1f}) no blade that bends to {:.1f} mm follows the design for {:.0f} mm to "
     "both sides, whichever way it lies",
     "bei ({:.1f}, {:.1f}, {:.1f}) folgt keine Klinge, die sich bis {:.1f} mm biegt, dem Entwurf {:.0f} mm "
     "weit "
     "nach beiden Seiten, wie sie auch liegt"},
    {"of it {:.3f} mm are what the controller's micrometres move a nearly straight blade by",
     "davon {:.3f} mm, um die Mikrometer der Steuerung eine fast gerade Klinge bewegen"},
    {"tries that failed: {}; that every one would is not proved",
     "gescheiterte Versuche: {}; dass jeder scheitert, ist nicht bewiesen"},
    {"a cut that is smooth across the design's facets there, {:.0f} mm wide, is off by that at least",
     "ein Schnitt, der dort glatt über die {:.0f} mm breiten Facetten des Entwurfs geht, weicht mindestens "
     "so "
     "weit ab"},
    {"first: {}", "die erste: {}"},
    {"within {:g} mm if the clamps are within {:g} mm and {:g} mrad",
     "auf {:g} mm genau, wenn die Klemmen auf {:g} mm und {:g} mrad genau sind"},
    {"not within {:g} mm for certain, however exact the clamps are",
     "nicht sicher auf {:g} mm genau, wie genau die Klemmen auch sind"},
    {"at any height of cell.raise_mm", "in jeder Höhe von cell.raise_mm"},
    // of arms
    {"arm {}", "Arm {}"},
    {"arm {} {}", "Arm {} {}"},
    {"arm {} {} from its limit", "Arm {} {} von seiner Grenze"},
    {"arm {} cannot reach clamp {}, {:.0f} mm short: another place of its base, or another height of the "
     "block",
     "Arm {} erreicht Klemme {} nicht, {:.0f} mm zu kurz: ein anderer Ort seines Fußes, oder eine andere "
     "Höhe des Blocks"},
    {"arm {} cannot reach clamp {}, {:.0f} mm too near: another place of its base, or another height of the "
     "block",
     "Arm {} erreicht Klemme {} nicht, {:.0f} mm zu nah: ein anderer Ort seines Fußes, oder eine andere "
     "Höhe des Blocks"},
    {"arm {} {}, limit {:.4g}, of which {:.3g} are kept ({:.3g} over): another jaw, or another place of the "
     "block",
     "Arm {} {}, Grenze {:.4g}, von der {:.3g} frei bleiben ({:.3g} darüber): eine andere Backe, oder ein "
     "anderer Ort des Blocks"},
    {"arm {} is next to singular: another jaw, or another place of the block",
     "Arm {} ist nahe an der Singularität: eine andere Backe, oder ein anderer Ort des Blocks"},
    {"{}, where the straight blade is bent to the strip's first shape: another place of the block",
     "{}, wo die gerade Klinge in die erste Form des Streifens gebogen wird: ein anderer Ort des Blocks"},
    {"{} and {}: not proved clear of {:.4g} mm between {:.3f} and {:.3f} s (bound {:.1f} mm)",
     "{} und {}: {:.4g} mm Abstand nicht bewiesen zwischen {:.3f} und {:.3f} s (Schranke {:.1f} mm)"},
    {"{} is {:.1f} mm from {}, {:.4g} at least ({:.1f} mm too near)",
     "{}: {:.1f} mm Abstand; gegenüber: {}; mindestens {:.4g} ({:.1f} mm zu nah)"},
    {"{}: another jaw, or another place of the block",
     "{}: eine andere Backe, oder ein anderer Ort des Blocks"},
    {"{}: raise the block (cell.raise_mm) or make the plinth smaller (plinth.inset_mm)",
     "{}: den Block höher stellen (cell.raise_mm) oder den Sockel kleiner machen (plinth.inset_mm)"},
    {"{}: raise the block (cell.raise_mm)", "{}: den Block höher stellen (cell.raise_mm)"},
    {"{}: another jaw, or bases farther apart", "{}: eine andere Backe, oder Füße weiter auseinander"},
    {"{}: another jaw, or another place of the block or of what stands there",
     "{}: eine andere Backe, oder ein anderer Ort des Blocks oder dessen, was dort steht"},
    {"{}: another place of the block (cell.place = \"search\" looks for one) or of what stands there",
     "{}: ein anderer Ort des Blocks (cell.place = \"search\" sucht einen) oder dessen, was dort steht"},
    {"{} would slow the cut to {:.2g} mm/s, {:.2g} mm/s at least (motion.min_feed_mm_s): tilt the jaw or "
     "turn the block",
     "{} würde den Schnitt auf {:.2g} mm/s bremsen, mindestens {:.2g} mm/s (motion.min_feed_mm_s): die "
     "Backe neigen oder den Block drehen"},
    {"raised {:.0f} mm", "{:.0f} mm höher"},
    {"raised {:.0f} mm, moved {:.0f}, {:.0f} mm", "{:.0f} mm höher, um {:.0f}, {:.0f} mm verschoben"},
    {"raised {:.0f} mm, turned {:.0f} degrees", "{:.0f} mm höher, um {:.0f} Grad gedreht"},
    {"raised {:.0f} mm, moved {:.0f}, {:.0f} mm, turned {:.0f} degrees",
     "{:.0f} mm höher, um {:.0f}, {:.0f} mm verschoben, um {:.0f} Grad gedreht"},
    {"{} ({}; of {} choices of place and arms {} are out of reach, {} at joint limits, {} next to singular, "
     "{} not clear, {} too slow a cut for a joint; cell {})",
     "{} ({}; von {} Möglichkeiten für Ort und Arme sind {} außer Reichweite, {} an Gelenkgrenzen, {} "
     "nahe an der Singularität, {} nicht frei, {} zu langsam für ein Gelenk; Zelle {})"},
    // warnings
    {"{}: blade nearly straight or taut at {} poses from {:.2f} s ({}) to {:.2f} s ({}): its clamps decide "
     "its shape to second order only, and their errors may move it by {:.1f} mm",
     "{}: die Klinge ist fast gerade oder straff in {} Stellungen von {:.2f} s ({}) bis {:.2f} s ({}): ihre "
     "Klemmen bestimmen ihre Form nur in zweiter Ordnung, und deren Fehler können sie um {:.1f} mm bewegen"},
    {"{}: the blade goes at {:.3g} mm/s square to itself, slower than foam.band_mm_at_mm_s tells ({:.3g} "
     "mm/s): it melts more than the {:.3g} mm that are taken there",
     "{}: die Klinge fährt mit {:.3g} mm/s quer zu sich, langsamer, als foam.band_mm_at_mm_s sagt ({:.3g} "
     "mm/s): sie schmilzt mehr als die {:.3g} mm, die dort angenommen sind"},
    {"design: height of the facets' chords ({:.3g} mm, limit {:.3g} mm): the cut follows its facets, not "
     "the surface that they stand for",
     "Entwurf: Höhe über den Sehnen der Facetten ({:.3g} mm, Grenze {:.3g} mm): der Schnitt folgt den "
     "Facetten, nicht der Fläche, für die sie stehen"},
    {"design: refused, and shown as it was looked at: poses eight times as far apart, the cut measured at "
     "half "
     "as many places a mm, the clamps' errors left out",
     "Entwurf: abgelehnt und gezeigt, wie er angesehen wurde: Stellungen achtmal so weit auseinander, der "
     "Schnitt an halb so vielen Stellen je mm gemessen, ohne Fehler der Klemmen"},
    {"design: {}", "Entwurf: {}"},
    {"error budget {:.4g} mm (tolerance {:g} mm), of it {:.4g} mm by clamps that err by {:g} mm and {:g} "
     "mrad: {}",
     "Fehlerbudget {:.4g} mm (Toleranz {:g} mm), davon {:.4g} mm durch Klemmen, die um {:g} mm und {:g} "
     "mrad falsch stehen: {}"},
    {"{}: arm {} joint {} comes within {:.1f} degrees of its limit at {:.2f} s",
     "{}: Arm {} Gelenk {} kommt seiner Grenze auf {:.1f} Grad nahe, bei {:.2f} s"},
    {"{}: arm {} comes within {:.1f} degrees of a straight wrist at {:.2f} s",
     "{}: Arm {} kommt einem geraden Handgelenk auf {:.1f} Grad nahe, bei {:.2f} s"},
    {"arm {}: accelerations are assumed: give acceleration_rad_s2 of the arm's maker",
     "Arm {}: Beschleunigungen sind angenommen: acceleration_rad_s2 vom Hersteller des Arms angeben"},
    {"arm {}: the tool has no shape: give its boxes",
     "Arm {}: das Werkzeug hat keine Gestalt: seine Quader angeben"},
    {"arm {}: no collision shape in its model: {}",
     "Arm {}: keine Gestalt für Zusammenstöße in seinem Modell: {}"},
    {"no table: give [table] size_mm", "kein Tisch: [table] size_mm angeben"},
    {"largest extent {:.6g} mm is less than clamps are apart ({:g} mm)",
     "die größte Ausdehnung, {:.6g} mm, ist kleiner als der Abstand der Klemmen ({:g} mm)"},
    {"{:.0f} % of the area is too steep or too sharp for the blade in any planes",
     "{:.0f} % der Fläche sind in jeder Lage der Ebenen zu steil oder zu scharf für die Klinge"},
    {"{:.0f} % of the area is too steep or too sharp for the blade in the planes given: others suit more of "
     "it",
     "{:.0f} % der Fläche sind in den vorgegebenen Ebenen zu steil oder zu scharf für die Klinge: zu anderen "
     "passt mehr davon"},
    {"largest extent {:.6g} mm: {} strips at least", "größte Ausdehnung {:.6g} mm: mindestens {} Streifen"},
    {"{}: is that the design's unit?", "{}: ist das die Einheit des Entwurfs?"},
    {"{}: is that the design's unit? {}", "{}: ist das die Einheit des Entwurfs? {}"},
    {"{} x {} x {} mm if in {}", "{} x {} x {} mm, wenn in {}"},
    {"{} x {} x {} mm if in {} ({} strips at least)", "{} x {} x {} mm, wenn in {} (mindestens {} Streifen)"},
    {"{}, {}", "{}, {}"},
    // why another setting may help
    {"the design is a closed solid, and most of it faces along y: its upper faces alone",
     "der Entwurf ist ein geschlossener Körper, und das meiste davon schaut entlang y: nur seine oberen "
     "Flächen"},
    {"the design is a closed solid: its upper faces alone",
     "der Entwurf ist ein geschlossener Körper: nur seine oberen Flächen"},
    {"the design is a closed solid: its faces towards {} alone",
     "der Entwurf ist ein geschlossener Körper: nur seine Flächen nach {}"},
    {"most of the design faces along y: {} may be up in it",
     "das meiste des Entwurfs schaut entlang y: vielleicht ist {} darin oben"},
    {"the surface stands upright", "die Fläche steht aufrecht"},
    {"the surface leans neither up nor down", "die Fläche neigt sich weder nach oben noch nach unten"},
    {"the planes that were given: others may do",
     "die Ebenen, die vorgegeben waren: andere genügen vielleicht"},
    {"what the cut deviates by; with another tolerance other ribs are chosen",
     "um so viel weicht der Schnitt ab; mit einer anderen Toleranz werden andere Rippen gewählt"},
    {"weight may use up a share of the tolerance", "das Gewicht darf einen Teil der Toleranz nutzen"},
    {"the share of the design that no strip reaches: only if it may stay uncut",
     "der Anteil des Entwurfs, den kein Streifen erreicht: nur wenn er ungeschnitten bleiben darf"},
    {"the smallest radius goes with the thickness of the blade; a thinner blade is held less firmly",
     "der kleinste Radius wächst mit der Dicke der Klinge; eine dünnere Klinge wird weniger fest gehalten"},
    {"the slowest point of the blade; slower foam melts wider, which is not modelled",
     "der langsamste Punkt der Klinge; langsamer schmilzt der Schaum breiter, was nicht mitgerechnet wird"},
    {"the time of the cut", "die Zeit des Schnitts"},
    {"the block stands higher, and with it the clamps", "der Block steht höher, und mit ihm die Klemmen"},
    {"the edge of the block this strip needs", "die Kante des Blocks, den dieser Streifen braucht"},
    {"one more length: clamps stay clear of the block; a blade that bends away needs more",
     "eine Länge mehr: die Klemmen bleiben frei vom Block; eine Klinge, die sich wegbiegt, braucht mehr"},
    {"{} passes, {} does not", "{} besteht, {} nicht"},
    {"without {}", "ohne {}"},
    {"{}; {}", "{}; {}"},
    // what was not checked
    {"snaps and bending by verify between every sixteenth waypoint; the plan checks every pose",
     "Durchschlagen und Biegung, von verify, zwischen je sechzehn Wegpunkten; der Plan prüft jede Stellung"},
    {"errors of the clamps in the measured deviation: they have a line in the budget, and an amber verdict "
     "says what they may be",
     "Fehler der Klemmen in der gemessenen Abweichung: sie haben eine Zeile im Budget, und ein gelbes "
     "Urteil sagt, wie groß sie sein dürfen"},
    {"melt-back of a held blade", "Nachschmelzen an einer gehaltenen Klinge"},
    {"melt-back of a slow or held blade", "Nachschmelzen an einer langsamen oder gehaltenen Klinge"},
    {"how much softer hot steel hangs than the blade that is measured: a fifth of its sag stands in the "
     "budget",
     "wie viel weicher heißer Stahl hängt als die Klinge, die gemessen ist: ein Fünftel ihres Durchhangs "
     "steht im Budget"},
    {"arm reach and arm collision", "Reichweite und Zusammenstöße der Arme"},
    {"thermal spring-back", "Rückfedern durch Wärme"},
    {"plinth outside the kept side", "Sockel außerhalb der Seite, die bleibt"},
    {"jerk of the clamps", "Ruck der Klemmen"},
    {"jerk of the clamps in the ramps of a hold", "Ruck der Klemmen in den Rampen eines Halts"},
    {"collisions of links that have no shape, of arm {}: {}",
     "Zusammenstöße von Gliedern ohne Gestalt, Arm {}: {}"},
    {"collisions of the tool of arm {}, which has no shape",
     "Zusammenstöße des Werkzeugs von Arm {}, das keine Gestalt hat"},
    {"the arms' approach from park, cables, load and torque",
     "Anfahrt der Arme aus der Parkstellung, Kabel, Last und Drehmoment"},
    // of a design
    {"coordinates of single precision, so far from the origin {} mm apart: move the design to the origin "
     "before it is exported, or export an OBJ",
     "Koordinaten einfacher Genauigkeit, so weit vom Ursprung {} mm auseinander: den Entwurf vor dem "
     "Exportieren zum Ursprung schieben, oder als OBJ exportieren"},
    {"{} face is not a simple polygon and cut as a fan, the first in line {}",
     "{} Fläche ist kein einfaches Vieleck und als Fächer zerlegt, die erste in Zeile {}"},
    {"{} faces are not a simple polygon and cut as a fan, the first in line {}",
     "{} Flächen sind kein einfaches Vieleck und als Fächer zerlegt, die erste in Zeile {}"},
    {"{} border vertex within {} mm of another border, the first at {}: if the sheets belong together, set "
     "design.stitch_mm",
     "{} Randecke näher als {} mm an einem anderen Rand, die erste bei {}: gehören die Flächen zusammen, "
     "design.stitch_mm setzen"},
    {"{} border vertices within {} mm of another border, the first at {}: if the sheets belong together, "
     "set design.stitch_mm",
     "{} Randecken näher als {} mm an einem anderen Rand, die erste bei {}: gehören die Flächen zusammen, "
     "design.stitch_mm setzen"},
    {"{} facet whose normal looks the other way than the corners go round: the corners count, the first in "
     "{} {}",
     "{} Facette, deren Normale anders schaut, als ihre Ecken herumgehen: die Ecken zählen, die erste in "
     "{} {}"},
    {"{} facets whose normals look the other way than the corners go round: the corners count, the first in "
     "{} {}",
     "{} Facetten, deren Normalen anders schauen, als ihre Ecken herumgehen: die Ecken zählen, die erste "
     "in {} {}"},
    {"{} facet whose normal is no finite number: the corners count, the first in {} {}",
     "{} Facette, deren Normale keine endliche Zahl ist: die Ecken zählen, die erste in {} {}"},
    {"{} facets whose normals are no finite number: the corners count, the first in {} {}",
     "{} Facetten, deren Normalen keine endlichen Zahlen sind: die Ecken zählen, die erste in {} {}"},
    {"{} facet has attribute bytes (colours), which are not read, the first in {} {}",
     "{} Facette hat Attributbytes (Farben), die nicht gelesen werden, die erste in {} {}"},
    {"{} facets have attribute bytes (colours), which are not read, the first in {} {}",
     "{} Facetten haben Attributbytes (Farben), die nicht gelesen werden, die erste in {} {}"},
    {"{} statements passed over, the first {}: only polygons are read",
     "{} Anweisungen übergangen, die erste {}: nur Vielecke werden gelesen"},
    {"triangle strips are passed over: only the faces are read",
     "Dreiecksstreifen sind übergangen: nur die Flächen werden gelesen"},
    {"{} primitive of lines or points passed over: only triangles are read",
     "{} Element aus Linien oder Punkten übergangen: nur Dreiecke werden gelesen"},
    {"{} primitives of lines or points passed over: only triangles are read",
     "{} Elemente aus Linien oder Punkten übergangen: nur Dreiecke werden gelesen"},
    {"{} mesh with a skin or morph targets read as at rest",
     "{} Netz mit Haut oder Morphzielen in Ruhe gelesen"},
    {"{} meshes with skins or morph targets read as at rest",
     "{} Netze mit Häuten oder Morphzielen in Ruhe gelesen"},
    {"{} pair of faces crosses, the first those of {}s {} and {} near {}: only one of them can be cut "
     "there, trim the sheets",
     "{} Paar Flächen kreuzt sich, zuerst die von {} {} und {} nahe {}: nur eine davon lässt sich dort "
     "schneiden, die Flächen beschneiden"},
    {"{} pairs of faces cross, the first those of {}s {} and {} near {}: only one of them can be cut there, "
     "trim the sheets",
     "{} Paare von Flächen kreuzen sich, zuerst die von {} {} und {} nahe {}: nur eine davon lässt sich "
     "dort schneiden, die Flächen beschneiden"},
    // in pictures
    {"{:.0f} x {:.0f} x {:.0f} mm, {} kept", "{:.0f} x {:.0f} x {:.0f} mm, bleibt: {}"},
    {"{} strip, {} ribs, {}", "{} Streifen, {} Rippen, {}"},
    {"{} strips, {} ribs, {}", "{} Streifen, {} Rippen, {}"},
    {"verification {}", "Prüfung {}"},
    {"amber: {}", "gelb: {}"},
    {"deviation max {:.2f}, p99 {:.2f} mm", "Abweichung höchstens {:.2f}, p99 {:.2f} mm"},
    {"uncut {:.0f} mm2", "ungeschnitten {:.0f} mm2"},
    {"override: {}", "übergangen: {}"},
    {"blade ends over other strips are left out: --strip shows them",
     "Enden der Klinge über anderen Streifen sind weggelassen: --strip zeigt sie"},
    {"{:.0f} x {:.0f} x {:.0f} mm (read as {})", "{:.0f} x {:.0f} x {:.0f} mm (gelesen in {})"},
    {"{} vertices, {} triangles", "{} Ecken, {} Dreiecke"},
    {"{} piece", "{} Stück"},
    {"{} pieces", "{} Stücke"},
    {"refused: {}", "abgelehnt: {}"},
    {"refused: {} (and {} more)", "abgelehnt: {} (und {} weitere)"},
    {"ringed: {}", "eingekreist: {}"},
    {"{}, blade {:g} mm", "{}, Klinge {:g} mm"},
    {"blade every {:.0f} mm", "Klinge alle {:.0f} mm"},
    {"and {} more, colours repeat", "und {} weitere, Farben wiederholen sich"},
    {"foam left standing: +", "Schaum steht noch: +"},
    {"tolerance +{:g}", "Toleranz +{:g}"},
    {"tolerance -{:g}", "Toleranz -{:g}"},
    {"cut too deep: -", "zu tief geschnitten: -"},
    {"allowed {:.3g}", "erlaubt {:.3g}"},
    {"design, not cut", "Entwurf, ungeschnitten"},
    {"planned ribs", "geplante Rippen"},
    {"foam block", "Schaumblock"},
};

}  // namespace

std::span<const std::pair<std::string_view, std::string_view>> german_words_of_limits() {
  return kWords;
}

std::span<const std::pair<std::string_view, std::string_view>> german_sentences() {
  return kSentences;
}

}  // namespace hotblade::pipeline
