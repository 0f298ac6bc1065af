#include "kinematics/kernel_run.hpp"

namespace polyglide {
namespace {

template <typename Columns, typename Move>
void for_each_output(Columns& out, const batch::KernelModel& model, const Move& move) {
  for (auto* column : {&out.condition, &out.frobenius, &out.smallest, &out.transmission,
                       &out.softest, &out.stiffest})
    move(*column, 1);
  move(out.drives, model.drives);
  move(out.jacobian, model.drives * model.columns);
}

void shift_columns(batch::KernelInput& in, std::size_t by) {
  const auto move = [by](const double*& column) {
    if (column) column += by;
  };
  move(in.x), move(in.y), move(in.z);
  for (auto& column : in.angle) move(column);
  for (auto& column : in.quaternion) move(column);
}

}  // namespace

KernelRun::KernelRun(const batch::KernelModel& model, const PoseBatch& poses, BatchResult& result)
    : model_(model), kernel_(batch::kernel_named(poses.instructions)) {
  in_ = {poses.x.data(), poses.y.data(), poses.z.data()};
  const auto given = [](const std::vector<double>& v) { return v.empty() ? nullptr : v.data(); };
  for (int k = 0; k < 4; ++k) in_.quaternion[k] = given(poses.quaternion[k]);
  for (int k = 0; k < 3; ++k) in_.angle[k] = given(poses.angles[k]);
  const auto wanted = [](std::vector<double>& v) { return v.empty() ? nullptr : v.data(); };
  out_.limit = result.limit.data();
  out_.orientation = result.orientation.empty() ? nullptr : result.orientation.data();
  out_.condition = wanted(result.inverse_condition);
  out_.frobenius = wanted(result.frobenius);
  out_.smallest = wanted(result.smallest);
  out_.transmission = wanted(result.transmission);
  out_.softest = wanted(result.softest);
  out_.stiffest = wanted(result.stiffest);
  out_.drives = wanted(result.drives);
  out_.jacobian = wanted(result.jacobian);
  out_.stride = poses.size();
}

void KernelRun::operator()(std::size_t first, std::size_t last) const {
  const std::size_t lanes = kernel_.lanes;
  for (std::size_t i = first; i < last; i += batch::kBlock) {
    const std::size_t count = std::min<std::size_t>(batch::kBlock, last - i);
    const std::size_t whole = count - count % lanes;
    if (whole > 0) run(i, whole);
    if (whole < count) run_rest(i + whole, count - whole);
  }
}

void KernelRun::run(std::size_t first, std::size_t count) const {
  batch::KernelInput in = in_;
  shift_columns(in, first);
  batch::KernelOutput out = out_;
  out.limit += first;
  if (out.orientation) out.orientation += first;
  for_each_output(out, model_, [first](double*& column, int) {
    if (column) column += first;
  });
  kernel_.evaluate(model_, in, out, static_cast<int>(count));
}

/// Poses that fill no register: padded with the last one.
void KernelRun::run_rest(std::size_t first, std::size_t count) const {
  constexpr std::size_t kWidest = batch::kMostLanes;
  double inputs[10][kWidest];
  batch::KernelInput in = in_;
  shift_columns(in, first);
  int used = 0;
  const auto pad = [&](const double*& column) {
    if (!column) return;
    double* to = inputs[used++];
    for (std::size_t i = 0; i < kWidest; ++i) to[i] = column[std::min(i, count - 1)];
    column = to;
  };
  pad(in.x), pad(in.y), pad(in.z);
  for (auto& column : in.angle) pad(column);
  for (auto& column : in.quaternion) pad(column);

  int limits[kWidest];
  signed char orientations[kWidest];
  double answers[6 + 7 * batch::kMostDrives][kWidest];
  batch::KernelOutput out = out_, whole = out_;
  out.limit = limits;
  if (out.orientation) out.orientation = orientations;
  out.stride = kWidest;
  int at = 0;
  for_each_output(out, model_, [&](double*& column, int columns) {
    if (column) column = answers[at];
    at += columns;
  });
  kernel_.evaluate(model_, in, out, kernel_.lanes);
  std::copy_n(limits, count, whole.limit + first);
  if (out.orientation) std::copy_n(orientations, count, whole.orientation + first);
  at = 0;
  for_each_output(whole, model_, [&](double*& column, int columns) {
    for (int c = 0; column && c < columns; ++c)
      std::copy_n(answers[at + c], count,
                  column + static_cast<std::size_t>(c) * out_.stride + first);
    at += columns;
  });
}

ForwardRun::ForwardRun(const batch::KernelModel& model, const DriveBatch& drives,
                       ForwardResult& result)
    : model_(model),
      kernel_(batch::kernel_named(drives.instructions)),
      drives_(drives),
      result_(result) {}

void ForwardRun::operator()(std::size_t first, std::size_t last) const {
  const auto lanes = static_cast<std::size_t>(kernel_.forward_lanes);
  const std::size_t whole = (last - first) - (last - first) % lanes;
  auto& pose = result_.pose;
  batch::ForwardColumns io{&drives_.drives[first],  drives_.size,    &pose[0][first],
                           &pose[1][first],         &pose[2][first], {},
                           &result_.residual[first]};
  for (int k = 0; k < 4; ++k) io.quaternion[k] = &pose[3 + k][first];
  if (whole > 0) kernel_.forward(model_, io, static_cast<int>(whole));
  if (whole < last - first) run_rest(first + whole, last - first - whole);
}

/// What fills no register, padded with the last one.
void ForwardRun::run_rest(std::size_t first, std::size_t count) const {
  constexpr std::size_t kWidest = batch::kMostLanes;
  const std::size_t rows = drives_.drives.size() / drives_.size;
  std::vector<double> drive(rows * kWidest);
  double pose[8][kWidest];
  for (std::size_t i = 0; i < kWidest; ++i) {
    const std::size_t from = first + std::min(i, count - 1);
    for (std::size_t d = 0; d < rows; ++d)
      drive[d * kWidest + i] = drives_.drives[d * drives_.size + from];
    for (std::size_t k = 0; k < 7; ++k) pose[k][i] = result_.pose[k][from];
  }
  kernel_.forward(model_,
                  {drive.data(),
                   kWidest,
                   pose[0],
                   pose[1],
                   pose[2],
                   {pose[3], pose[4], pose[5], pose[6]},
                   pose[7]},
                  kernel_.forward_lanes);
  for (std::size_t k = 0; k < 7; ++k) std::copy_n(pose[k], count, &result_.pose[k][first]);
  std::copy_n(pose[7], count, &result_.residual[first]);
}

}  // namespace polyglide
