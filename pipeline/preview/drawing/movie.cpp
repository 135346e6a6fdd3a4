#include "pipeline/preview/drawing/movie.hpp"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkOggTheoraWriter.h>

#include "pipeline/preview/drawing/stage.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::preview {

namespace fs = std::filesystem;

void write_movie(const ViewModel& model, ViewState state, const MovieOptions& options, const fs::path& file,
                 bool force, const std::function<void(double)>& report) {
  expect_writable(file, force);
  const DraftFile draft(file);
  vtkNew<vtkOggTheoraWriter> writer;
  writer->SetFileName(draft.path().c_str());
  writer->SetRate(options.frames_per_s);
  writer->SetQuality(2);
  Painter painter(options.size);
  Stage stage(model, painter.renderer(), options.size, Painter::kZoom);
  state.cut_so_far = true;
  for (int i = 0; i < options.frames; ++i) {
    const double share = options.frames > 1 ? static_cast<double>(i) / (options.frames - 1) : 1;
    report(share);
    stage.show(after_seek(state, model.facts, share));
    vtkNew<vtkImageData> image;
    painter.paint(*image);
    writer->SetInputData(image);
    if (i == 0) writer->Start();
    writer->Write();
    if (writer->GetError() != 0)
      throw Error(ErrorKind::kFile, file.string() + ": the film cannot be written");
  }
  writer->End();
  draft.place();
}

}  // namespace hotblade::pipeline::preview
