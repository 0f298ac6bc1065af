#include "engines/mujoco_oracle.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <stdexcept>

namespace polyglide::engines {
namespace {

/// A model from text: MuJoCo reads files, real ones or from its own file system in memory.
mjModel* load(const std::string& xml) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "model.xml", static_cast<int>(xml.size()));
  std::copy(xml.begin(), xml.end(), static_cast<char*>(files->filedata[0]));
  std::array<char, 1000> error{};
  mjModel* model =
      mj_loadXML("model.xml", files.get(), error.data(), static_cast<int>(error.size()));
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo refuses the model: ") + error.data());
  return model;
}

int rows_of(int equality) { return equality == mjEQ_WELD ? 6 : equality == mjEQ_CONNECT ? 3 : 1; }

}  // namespace

MujocoModel::MujocoModel(const std::string& xml)
    : model_(load(xml), mj_deleteModel), data_(mj_makeData(model_.get()), mj_deleteData) {
  model_->opt.jacobian = mjJAC_DENSE;
}

int MujocoModel::find(int kind, const std::string& name) const {
  const int id = mj_name2id(model_.get(), kind, name.c_str());
  if (id < 0) throw std::runtime_error("MuJoCo's model has no " + name);
  return id;
}

void MujocoModel::set(const std::string& joint, const std::vector<double>& values) {
  const int address = model_->jnt_qposadr[find(mjOBJ_JOINT, joint)];
  std::copy(values.begin(), values.end(), data_->qpos + address);
}

void MujocoModel::place() { mj_fwdPosition(model_.get(), data_.get()); }

int MujocoModel::expected_rows() const {
  int rows = 0;
  for (int i = 0; i < model_->neq; ++i) rows += rows_of(model_->eq_type[i]);
  return rows;
}

int MujocoModel::velocities() const { return model_->nv; }

ConstraintSystem MujocoModel::constraints() {
  place();
  const mjModel& m = *model_;
  const mjData& d = *data_;
  ConstraintSystem answer;
  answer.rows = d.ne;
  answer.columns = m.nv;
  answer.jacobian.assign(d.efc_J, d.efc_J + d.ne * m.nv);
  answer.residual.assign(d.efc_pos, d.efc_pos + d.ne);
  for (int row = 0, within = 0; row < d.ne; ++row) {
    within = row > 0 && d.efc_id[row] == d.efc_id[row - 1] ? within + 1 : 0;
    // A weld: three lengths, then three angles. A coupled joint of ours is a slide.
    answer.row_is_length.push_back(within < 3);
  }
  answer.column_is_driven.assign(m.nv, false);
  for (int v = 0; v < m.nv; ++v) answer.column_is_length.push_back(is_slide(v));
  for (int i = 0; i < m.nu; ++i) {
    const int joint = m.actuator_trnid[2 * i];
    int index = m.jnt_dofadr[joint];
    if (m.jnt_type[joint] == mjJNT_BALL)  // its gear says which of the three
      while (m.actuator_gear[6 * i + index - m.jnt_dofadr[joint]] == 0) ++index;
    answer.column_is_driven[index] = true;
  }
  const int tool = find(mjOBJ_SITE, "tool");
  answer.platform = body_jacobian(mj_id2name(model_.get(), mjOBJ_BODY, m.site_bodyid[tool]));
  return answer;
}

std::vector<double> MujocoModel::body_pose(const std::string& body) {
  place();
  const int id = find(mjOBJ_BODY, body);
  std::vector<double> pose(data_->xpos + 3 * id, data_->xpos + 3 * id + 3);
  pose.insert(pose.end(), data_->xquat + 4 * id, data_->xquat + 4 * id + 4);
  return pose;
}

std::vector<double> MujocoModel::body_jacobian(const std::string& body) {
  place();
  std::vector<double> jacobian(6 * model_->nv);
  mj_jacBody(model_.get(), data_.get(), jacobian.data() + 3 * model_->nv, jacobian.data(),
             find(mjOBJ_BODY, body));
  return jacobian;
}

int MujocoModel::velocity_index(const std::string& joint) const {
  return model_->jnt_dofadr[find(mjOBJ_JOINT, joint)];
}

bool MujocoModel::is_slide(int velocity) const {
  return model_->jnt_type[model_->dof_jntid[velocity]] == mjJNT_SLIDE;
}

}  // namespace polyglide::engines
