#include "pipeline/cell/robot_names.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace hotblade::pipeline {

namespace {

// All words in capitals, as names are compared.
// The reserved words of RAPID. Neither table has been held against the maker's manual of one release: a word
// that is missing is found where the controller loads the program.
constexpr std::array<std::string_view, 58> kRapidWords{
    "ALIAS",     "AND",     "BACKWARD", "CASE",     "CONNECT",   "CONST", "DEFAULT",   "DIV",
    "DO",        "ELSE",    "ELSEIF",   "ENDFOR",   "ENDFUNC",   "ENDIF", "ENDMODULE", "ENDPROC",
    "ENDRECORD", "ENDTEST", "ENDTRAP",  "ENDWHILE", "ERROR",     "EXIT",  "FALSE",     "FOR",
    "FROM",      "FUNC",    "GOTO",     "IF",       "INOUT",     "LOCAL", "MOD",       "MODULE",
    "NOSTEPIN",  "NOT",     "NOVIEW",   "OR",       "PERS",      "PROC",  "RAISE",     "READONLY",
    "RECORD",    "RETRY",   "RETURN",   "STEP",     "SYSMODULE", "TASK",  "TEST",      "THEN",
    "TO",        "TRAP",    "TRUE",     "TRYNEXT",  "UNDO",      "VAR",   "VIEWONLY",  "WHILE",
    "WITH",      "XOR"};
// What a controller brings and exported modules use, or nobody may declare.
constexpr std::array<std::string_view, 29> kRapidBrought{
    "BOOL",         "CONFJ",    "CONFL",   "FINE",     "LOAD",      "MOVEABSJ",    "MOVEJ",      "MOVEL",
    "NUM",          "SETDO",    "STEMPTY", "STRING",   "SYNCIDENT", "SYNCMOVEOFF", "SYNCMOVEON", "TASKS",
    "TOOL0",        "TOOLDATA", "TPERASE", "TPREADFK", "TPWRITE",   "UNLOAD",      "V100",       "V1000",
    "WAITSYNCTASK", "WAITTIME", "WOBJ0",   "WOBJDATA", "Z0"};
// What exported modules declare (pipeline/export/rapid.cpp).
constexpr std::array<std::string_view, 8> kRapidMade{"HB_HELD", "HB_KEY",   "HB_MAIN",  "HB_OFF",
                                                     "HB_ON",   "HB_READY", "HB_TASKS", "HB_THERE"};
// The keywords of KRL with its types and operators.
constexpr std::array<std::string_view, 111> kKrlWords{
    "AND",      "ANIN",     "ANOUT",   "AXIS",      "BOOL",    "BRAKE",   "B_AND",     "B_EXOR",
    "B_NOT",    "B_OR",     "CASE",    "CAST_FROM", "CAST_TO", "CCLOSE",  "CHANNEL",   "CHAR",
    "CIRC",     "CIRC_REL", "CONST",   "CONTINUE",  "COPEN",   "CREAD",   "CWRITE",    "C_DIS",
    "C_ORI",    "C_PTP",    "C_SPL",   "C_VEL",     "DECL",    "DEF",     "DEFAULT",   "DEFDAT",
    "DEFFCT",   "DELAY",    "DIGIN",   "DISTANCE",  "DO",      "E6AXIS",  "E6POS",     "ELSE",
    "END",      "ENDDAT",   "ENDFCT",  "ENDFOR",    "ENDIF",   "ENDLOOP", "ENDSPLINE", "ENDSWITCH",
    "ENDWHILE", "ENUM",     "EXIT",    "EXOR",      "EXT",     "EXTFCT",  "FALSE",     "FOR",
    "FRAME",    "GLOBAL",   "GOTO",    "HALT",      "IF",      "IMPORT",  "INT",       "INTERRUPT",
    "IS",       "LIN",      "LIN_REL", "LOOP",      "MAXIMUM", "MINIMUM", "NOT",       "OFF",
    "ON",       "OR",       "PATH",    "POS",       "PRIO",    "PTP",     "PTP_REL",   "PTP_SPLINE",
    "PUBLIC",   "PULSE",    "REAL",    "REPEAT",    "RESUME",  "RETURN",  "SCIRC",     "SCIRC_REL",
    "SEC",      "SIGNAL",   "SLIN",    "SLIN_REL",  "SPL",     "SPLINE",  "SPL_REL",   "SPTP",
    "SPTP_REL", "SREAD",    "STOP",    "STRUC",     "SWITCH",  "SWRITE",  "THEN",      "TIME_BLOCK",
    "TO",       "TRIGGER",  "TRUE",    "UNTIL",     "WAIT",    "WHEN",    "WHILE"};
// What a controller brings and exported routines use (pipeline/export/krl.cpp).
constexpr std::array<std::string_view, 8> kKrlBrought{"BAS",  "BASE_DATA", "INITMOV",   "MSGNOTIFY",
                                                      "PART", "START",     "TOOL_DATA", "VEL_PTP"};

// The characters of the longest name.
constexpr std::size_t kLongestRapid = 32, kLongestKrl = 24;

char capital(char c) {
  return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}
bool is_letter(char c) {
  return capital(c) >= 'A' && capital(c) <= 'Z';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Modules, routines and files of strips (S001 and on) and of whole jobs.
bool made_of_a_job(std::string_view capitals) {
  constexpr std::string_view kStrip = "HB_S", kMain = "HB_MAIN_";
  if (capitals.starts_with(kMain)) return true;
  return capitals.starts_with(kStrip) && capitals.size() > kStrip.size() && is_digit(capitals[kStrip.size()]);
}

}  // namespace

std::string robot_name_of(const std::string& arm_id) {
  std::string name = arm_id;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !is_letter(c) && !is_digit(c); }, '_');
  return name;
}

bool same_robot_name(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return capital(x) == capital(y); });
}

std::string robot_name_fault(RobotLanguage language, std::string_view name) {
  const bool rapid = language == RobotLanguage::kRapid;
  const std::string of = rapid ? "RAPID" : "KRL";
  const std::size_t longest = rapid ? kLongestRapid : kLongestKrl;
  const auto part = [](char c) { return is_letter(c) || is_digit(c) || c == '_'; };
  if (name.empty() || name.size() > longest || !is_letter(name.front()) ||
      !std::all_of(name.begin(), name.end(), part))
    return "is no name in " + of + ": letters, digits and _, " + std::to_string(longest) + " at most";
  std::string capitals(name);
  std::transform(name.begin(), name.end(), capitals.begin(), capital);
  const auto among = [&](std::span<const std::string_view> words) {
    return std::find(words.begin(), words.end(), capitals) != words.end();
  };
  if (rapid ? among(kRapidWords) : among(kKrlWords)) return "is a word of " + of + ": another name";
  if (rapid ? among(kRapidBrought) : among(kKrlBrought))
    return "is what a controller calls something of its own: another name";
  if ((rapid && among(kRapidMade)) || made_of_a_job(capitals))
    return "is what exported programs call something of their own: another name";
  return "";
}

}  // namespace hotblade::pipeline
