// What draws has to be of the program's version.
#include "pipeline/preview/drawing.hpp"

#include <gmock/gmock.h>

#include "pipeline/preview/drawing/vtk_drawing.hpp"
#include "pipeline/program/version.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::preview {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct OfVersion final : Drawing {
  explicit OfVersion(std::string of) : version_(std::move(of)) {}
  const char* version() const override { return version_.c_str(); }
  void load_driver() const override { ++loaded; }
  std::unique_ptr<const DrawnScene> drawn(const Scene& /*scene*/) const override { return nullptr; }
  void write_vtm(const Scene& /*scene*/, const std::filesystem::path& /*file*/,
                 bool /*force*/) const override {}
  std::string png_of(const ViewModel& /*model*/, const ViewState& /*state*/,
                     PictureSize /*size*/) const override {
    return {};
  }
  void write_movie(const ViewModel& /*model*/, const ViewState& /*state*/, const MovieOptions& /*options*/,
                   const std::filesystem::path& /*file*/, bool /*force*/,
                   const std::function<void(double)>& /*report*/) const override {}
  void expect_display() const override {}
  void show(const ViewModel& /*model*/, const ViewState& /*state*/, PictureSize /*size*/) const override {}

  mutable int loaded = 0;

 private:
  std::string version_;
};

// Has `one` draw as long as it is in scope.
struct DrawnWith {
  explicit DrawnWith(const Drawing& one) { draw_with(one); }
  ~DrawnWith() { draw_with(vtk_drawing()); }
  DrawnWith(const DrawnWith&) = delete;
  DrawnWith& operator=(const DrawnWith&) = delete;
};

TEST(Drawing, OfAnotherVersionIsRefused) {
  const OfVersion old("0.0.1");
  const DrawnWith with(old);
  EXPECT_THAT([] { (void)drawing(); }, ::testing::ThrowsMessage<Error>(AllOf(
                                           HasSubstr("0.0.1"), HasSubstr(version()), HasSubstr("install"))));
  // A driver loaded ahead of time says nothing: the first picture does.
  EXPECT_NO_THROW(load_driver());
  EXPECT_EQ(old.loaded, 0);
}

TEST(Drawing, OfTheProgramsVersionDraws) {
  const OfVersion same(version());
  const DrawnWith with(same);
  EXPECT_EQ(&drawing(), &same);
  load_driver();
  EXPECT_EQ(same.loaded, 1);
}

}  // namespace
}  // namespace hotblade::pipeline::preview
