#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <vtkCellArray.h>
#include <vtkGenericCell.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStaticCellLocator.h>

#include <cmath>

#include "tests/bench/distance_peers.hpp"

namespace hotblade::bench {
namespace {

class Vtk : public Peer {
 public:
  explicit Vtk(const PeerMesh& mesh) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const auto& v : mesh.vertices) points->InsertNextPoint(v.data());
    vtkNew<vtkCellArray> cells;
    for (const auto& t : mesh.triangles) {
      const vtkIdType ids[3] = {t[0], t[1], t[2]};
      cells->InsertNextCell(3, ids);
    }
    data_->SetPoints(points);
    data_->SetPolys(cells);
    locator_->SetDataSet(data_);
    locator_->BuildLocator();
  }
  void query(const std::vector<std::array<double, 3>>& points,
             std::vector<double>& distances) const override {
    distances.resize(points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 256), [&](const auto& range) {
      vtkNew<vtkGenericCell> cell;
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        double nearest[3], sq = 0;
        vtkIdType id = 0;
        int sub = 0;
        locator_->FindClosestPoint(points[i].data(), nearest, cell, id, sub, sq);
        distances[i] = std::sqrt(sq);
      }
    });
  }

 private:
  vtkNew<vtkPolyData> data_;
  vtkNew<vtkStaticCellLocator> locator_;
};

}  // namespace

std::unique_ptr<Peer> vtk_locator(const PeerMesh& mesh) {
  return std::make_unique<Vtk>(mesh);
}

}  // namespace hotblade::bench
