// SPDX-License-Identifier: Apache-2.0
// Known formats that are not read, by extension; see foreign_format.hpp.
#include "scene/mesh/foreign_format.hpp"

#include <filesystem>

namespace clray {

namespace {

struct Family {
  const char* extensions;  // with a blank before and after each
  const char* advice;
};

constexpr Family kFamilies[] = {
    {" .gltf .glb .dae .3ds .fbx .blend .x3d .wrl .vrml .3mf .amf .ac .lwo .lws .x .ms3d .usd .usda .usdc .usdz .max "
     ".c4d .ma .mb ",
     "a 3D scene; export it as OBJ, for example with Blender or 'assimp export model model.obj'"},
    {" .step .stp .iges .igs .brep .sldprt .sldasm .catpart .catproduct .ipt .iam .par .prt .asm .x_t .jt .dwg .dxf "
     ".fcstd .scad ",
     "a CAD model; export it as STL or OBJ, for example with FreeCAD or Gmsh"},
    {" .tab .plt .fac .bds ",
     "a shape table; write its vertices as 'v x y z' and its plates as 'f i j k' (counted from 1) into an OBJ file"},
    {" .msh .vtk .vtu .vtp .inp .unv .bdf .nas .cgns .med .xyz .pts .pcd .las .laz ",
     "a grid or point file; export its surface as PLY, STL or OBJ, for example with ParaView or MeshLab"},
    {" .gz .zip .bz2 .xz .zst .7z .tar .tgz .rar ", "a packed file; unpack it first"},
};

}  // namespace

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return extension;
}

std::string foreign_format(const std::string& path) {
  const std::string extension = extension_of(path);
  if (extension.empty() || extension.find(' ') != std::string::npos) return {};
  for (const Family& family : kFamilies) {
    if (std::string(family.extensions).find(" " + extension + " ") != std::string::npos)
      return extension + " is " + family.advice;
  }
  return {};
}

}  // namespace clray
