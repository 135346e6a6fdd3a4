#include "pipeline/export/dxf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace hotblade::pipeline {

namespace {

constexpr int kMillimetres = 4;  // $INSUNITS

// Handles that others point to; all further ones are counted up from kFirstFree.
constexpr unsigned kNobody = 0, kRoot = 1, kModelSpace = 2, kPaperSpace = 3, kFirstFree = 0x10;

// A file is a list of pairs: a group code on one line, its value on the next.
class DxfText {
 public:
  void pair(int code, std::string_view value) {
    fmt::format_to(std::back_inserter(text_), "{}\n{}\n", code, value);
  }
  void pair(int code, int value) { pair(code, fmt::format("{}", value)); }
  void handle(int code, unsigned value) { pair(code, fmt::format("{:X}", value)); }
  void length(int code, double mm) { pair(code, fmt::format("{:.9f}", mm)); }
  void point(const Eigen::Vector2d& p) {
    length(10, p.x());
    length(20, p.y());
  }
  unsigned own_handle(unsigned owner, int code = 5) {
    const unsigned mine = next_++;
    handle(code, mine);
    handle(330, owner);
    return mine;
  }
  void begin(const char* section) {
    pair(0, "SECTION");
    pair(2, section);
  }
  void end() { pair(0, "ENDSEC"); }
  [[nodiscard]] unsigned next() const { return next_; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  unsigned next_ = kFirstFree;
};

unsigned begin_table(DxfText& out, const char* name, std::size_t entries) {
  out.pair(0, "TABLE");
  out.pair(2, name);
  const unsigned table = out.own_handle(kNobody);
  out.pair(100, "AcDbSymbolTable");
  out.pair(70, static_cast<int>(entries));
  return table;
}

// A named record; the caller goes on with what its kind needs.
void begin_record(DxfText& out, unsigned table, const char* kind, const char* subclass,
                  const std::string& name) {
  out.pair(0, kind);
  out.own_handle(table, std::string_view(kind) == "DIMSTYLE" ? 105 : 5);
  out.pair(100, "AcDbSymbolTableRecord");
  out.pair(100, subclass);
  out.pair(2, name);
  out.pair(70, 0);
}

void end_table(DxfText& out) {
  out.pair(0, "ENDTAB");
}

void empty_table(DxfText& out, const char* name) {
  begin_table(out, name, 0);
  end_table(out);
}

void write_line_types(DxfText& out) {
  const unsigned table = begin_table(out, "LTYPE", 3);
  for (const char* name : {"ByBlock", "ByLayer", "Continuous"}) {
    begin_record(out, table, "LTYPE", "AcDbLinetypeTableRecord", name);
    out.pair(3, "");
    out.pair(72, 65);
    out.pair(73, 0);
    out.pair(40, "0.0");
  }
  end_table(out);
}

void write_layers(DxfText& out, const std::vector<DxfCurve>& curves) {
  std::vector<std::string> names{"0"};
  for (const DxfCurve& c : curves) names.push_back(c.name);
  const unsigned table = begin_table(out, "LAYER", names.size());
  for (const std::string& name : names) {
    begin_record(out, table, "LAYER", "AcDbLayerTableRecord", name);
    out.pair(62, 7);  // black or white, whatever the background is not
    out.pair(6, "Continuous");
  }
  end_table(out);
}

void write_text_style(DxfText& out) {
  const unsigned table = begin_table(out, "STYLE", 1);
  begin_record(out, table, "STYLE", "AcDbTextStyleTableRecord", "Standard");
  for (const auto& [code, value] :
       {std::pair{40, "0.0"}, {41, "1.0"}, {50, "0.0"}, {71, "0"}, {42, "2.5"}, {3, "txt"}, {4, ""}})
    out.pair(code, value);
  end_table(out);
}

void write_dimension_style(DxfText& out) {
  const unsigned table = begin_table(out, "DIMSTYLE", 1);
  out.pair(100, "AcDbDimStyleTable");
  out.pair(71, 0);
  begin_record(out, table, "DIMSTYLE", "AcDbDimStyleTableRecord", "Standard");
  end_table(out);
}

void write_block_records(DxfText& out) {
  const unsigned table = begin_table(out, "BLOCK_RECORD", 2);
  for (const auto& [name, mine] : {std::pair{"*Model_Space", kModelSpace}, {"*Paper_Space", kPaperSpace}}) {
    out.pair(0, "BLOCK_RECORD");
    out.handle(5, mine);
    out.handle(330, table);
    out.pair(100, "AcDbSymbolTableRecord");
    out.pair(100, "AcDbBlockTableRecord");
    out.pair(2, name);
  }
  end_table(out);
}

void write_tables(DxfText& out, const std::vector<DxfCurve>& curves) {
  out.begin("TABLES");
  empty_table(out, "VPORT");
  write_line_types(out);
  write_layers(out, curves);
  write_text_style(out);
  empty_table(out, "VIEW");
  empty_table(out, "UCS");
  const unsigned applications = begin_table(out, "APPID", 1);
  begin_record(out, applications, "APPID", "AcDbRegAppTableRecord", "ACAD");
  end_table(out);
  write_dimension_style(out);
  write_block_records(out);
  out.end();
}

void write_blocks(DxfText& out) {
  out.begin("BLOCKS");
  for (const auto& [name, record] : {std::pair{"*Model_Space", kModelSpace}, {"*Paper_Space", kPaperSpace}}) {
    out.pair(0, "BLOCK");
    out.own_handle(record);
    out.pair(100, "AcDbEntity");
    out.pair(8, "0");
    out.pair(100, "AcDbBlockBegin");
    out.pair(2, name);
    out.pair(70, 0);
    out.point({0, 0});
    out.length(30, 0);
    out.pair(3, name);
    out.pair(1, "");
    out.pair(0, "ENDBLK");
    out.own_handle(record);
    out.pair(100, "AcDbEntity");
    out.pair(8, "0");
    out.pair(100, "AcDbBlockEnd");
  }
  out.end();
}

void begin_entity(DxfText& out, const char* kind, const std::string& layer, const char* subclass) {
  out.pair(0, kind);
  out.own_handle(kModelSpace);
  out.pair(100, "AcDbEntity");
  out.pair(8, layer);
  out.pair(100, subclass);
}

void write_curve(DxfText& out, const DxfCurve& curve, double text_height_mm) {
  out.pair(999, curve.note);
  begin_entity(out, "LWPOLYLINE", curve.name, "AcDbPolyline");
  out.pair(90, static_cast<int>(curve.vertices.size()));
  out.pair(70, 0);
  for (const DxfVertex& v : curve.vertices) {
    out.point(v.at);
    if (v.bulge != 0) out.pair(42, fmt::format("{:.15g}", v.bulge));
  }
  begin_entity(out, "TEXT", curve.name, "AcDbText");
  out.point(curve.label);
  out.length(30, 0);
  out.length(40, text_height_mm);
  out.pair(1, curve.name);
  out.pair(100, "AcDbText");
}

void write_objects(DxfText& out) {
  out.begin("OBJECTS");
  out.pair(0, "DICTIONARY");
  out.handle(5, kRoot);
  out.handle(330, kNobody);
  out.pair(100, "AcDbDictionary");
  out.pair(281, 1);
  out.pair(3, "ACAD_GROUP");
  out.handle(350, out.next());
  out.pair(0, "DICTIONARY");
  out.own_handle(kRoot);
  out.pair(100, "AcDbDictionary");
  out.pair(281, 1);
  out.end();
}

// Last to be made and first in the file: it tells the first handle that is free.
std::string header(unsigned free_handle) {
  DxfText out;
  out.begin("HEADER");
  out.pair(9, "$ACADVER");
  out.pair(1, "AC1015");
  out.pair(9, "$HANDSEED");
  out.handle(5, free_handle);
  out.pair(9, "$INSUNITS");
  out.pair(70, kMillimetres);
  out.pair(9, "$MEASUREMENT");
  out.pair(70, 1);  // metric
  out.end();
  return out.text();
}

}  // namespace

std::string dxf_document(const std::vector<DxfCurve>& curves, double text_height_mm) {
  DxfText out;
  write_tables(out, curves);
  write_blocks(out);
  out.begin("ENTITIES");
  for (const DxfCurve& curve : curves) write_curve(out, curve, text_height_mm);
  out.end();
  write_objects(out);
  return header(out.next()) + out.text() + "0\nEOF\n";
}

}  // namespace hotblade::pipeline
