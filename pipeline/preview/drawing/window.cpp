#include "pipeline/preview/drawing/window.hpp"

#include <vtkCallbackCommand.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>

#include "pipeline/preview/drawing/stage.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::preview {
namespace {

// Turns, moves and zooms; VTK's own keys (which would end or recolour) are not this window's.
class DragStyle : public vtkInteractorStyleTrackballCamera {
 public:
  static DragStyle* New() {
    auto* style = new DragStyle;
    style->InitializeObjectBase();
    return style;
  }
  void OnChar() override {}
  void OnKeyPress() override {}
  void OnLeftButtonDown() override {
    if (!press()) vtkInteractorStyleTrackballCamera::OnLeftButtonDown();
  }
  void OnMouseMove() override {
    if (!move()) vtkInteractorStyleTrackballCamera::OnMouseMove();
  }
  void OnLeftButtonUp() override {
    vtkInteractorStyleTrackballCamera::OnLeftButtonUp();
    release();
  }

  // The window's own part in the pointer: true where the picture is not to be turned.
  std::function<bool()> press, move;
  std::function<void()> release;
};

constexpr unsigned long kTickMs = 25;
// A pointer that has moved less between press and release has clicked, pixels.
constexpr int kClickReach = 3;

class Viewer {
 public:
  Viewer(const ViewModel& model, const ViewState& state, PictureSize size) : model_(model), state_(state) {
    window_->SetSize(size.width, size.height);
    window_->SetWindowName(("hotblade: " + model.scene.title).c_str());
    window_->SetMultiSamples(0);  // four times the work on software rasterisers
    window_->AddRenderer(renderer_);
    stage_ = std::make_unique<Stage>(model, *renderer_, size, 1);
    interactor_->SetInteractorStyle(style_);
    interactor_->SetRenderWindow(window_);
    command_->SetClientData(this);
    command_->SetCallback([](vtkObject*, unsigned long event, void* viewer, void*) {
      static_cast<Viewer*>(viewer)->on(event);
    });
    for (const auto event : {vtkCommand::KeyPressEvent, vtkCommand::TimerEvent, vtkCommand::ConfigureEvent})
      interactor_->AddObserver(event, command_);
    style_->press = [this] { return press(); };
    style_->move = [this] { return move(); };
    style_->release = [this] { release(); };
  }

  void run() {
    interactor_->Initialize();
    fit_size();
    stage_->show(state_);
    window_->Render();
    interactor_->CreateRepeatingTimer(kTickMs);
    interactor_->Start();
  }

 private:
  using Clock = std::chrono::steady_clock;

  void on(unsigned long event) {
    if (event == vtkCommand::KeyPressEvent) {
      change(after_key(state_, model_.facts, key_name()));
    } else if (event == vtkCommand::TimerEvent) {
      tick();
    } else if (event == vtkCommand::ConfigureEvent) {
      if (fit_size()) change(state_);
    }
  }

  // X11 names the letter of the key cap; with shift the letter is meant.
  std::string key_name() const {
    const char* symbol = interactor_->GetKeySym();
    std::string name = symbol ? symbol : "";
    const bool letter = name.size() == 1 && std::isalpha(static_cast<unsigned char>(name[0]));
    if (letter && interactor_->GetShiftKey()) name[0] = static_cast<char>(std::toupper(name[0]));
    return name;
  }

  void change(const ViewState& next) {
    state_ = next;
    if (state_.closed) {
      interactor_->TerminateApp();
      return;
    }
    stage_->show(state_);
    window_->Render();
  }

  void tick() {
    const auto now = Clock::now();
    // A window that was held up goes on where it was.
    constexpr double kLongestStep = 0.25;
    const double elapsed = std::min(std::chrono::duration<double>(now - last_tick_).count(), kLongestStep);
    last_tick_ = now;
    if (state_.playing) change(after_clock(state_, model_.facts, elapsed));
  }

  // True when the window has another size than the picture in it.
  bool fit_size() {
    const int* size = window_->GetSize();
    if (size[0] == stage_->size().width && size[1] == stage_->size().height) return false;
    stage_->resize({size[0], size[1]});
    return true;
  }

  bool press() {
    const int* place = interactor_->GetEventPosition();
    pressed_ = {place[0], place[1]};
    const bool on_bar = time_share_at(stage_->size(), place[0], place[1]).has_value();
    seeking_ = on_bar && model_.facts.end_s() > 0;
    return move();
  }

  // While the bar is held the pointer may leave its height.
  bool move() {
    if (!seeking_) return false;
    const double share = time_share_along(stage_->size(), interactor_->GetEventPosition()[0]);
    change(after_seek(state_, model_.facts, share));
    return true;
  }

  void release() {
    if (seeking_) {
      seeking_ = false;
      return;
    }
    const int* place = interactor_->GetEventPosition();
    const bool clicked = std::abs(place[0] - pressed_[0]) + std::abs(place[1] - pressed_[1]) < kClickReach;
    if (clicked) change(after_pick(state_, model_.facts, stage_->pick_at(state_, place[0], place[1])));
  }

  const ViewModel& model_;
  ViewState state_;
  vtkNew<vtkRenderer> renderer_;
  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderWindowInteractor> interactor_;
  vtkNew<DragStyle> style_;
  vtkNew<vtkCallbackCommand> command_;
  std::unique_ptr<Stage> stage_;
  std::array<int, 2> pressed_{0, 0};
  bool seeking_ = false;
  Clock::time_point last_tick_ = Clock::now();
};

}  // namespace

void show(const ViewModel& model, const ViewState& state, PictureSize size) {
  expect_display();
  Viewer viewer(model, state, size);
  viewer.run();
}

}  // namespace hotblade::pipeline::preview
