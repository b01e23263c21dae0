// SPDX-License-Identifier: Apache-2.0
// OpenVDB with the grids that this component makes. A grid has virtual functions for everything that can be done with it, which
// every source that makes one would instantiate: a minute of compilation. They are instantiated in openvdb_grids.cpp alone.
#pragma once

#include <openvdb/openvdb.h>

extern template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
extern template class openvdb::tree::Tree<openvdb::Vec3STree::RootNodeType>;
extern template class openvdb::tree::Tree<openvdb::Int32Tree::RootNodeType>;
extern template class openvdb::tree::Tree<openvdb::Int64Tree::RootNodeType>;
extern template class openvdb::tree::Tree<openvdb::MaskTree::RootNodeType>;
extern template class openvdb::Grid<openvdb::FloatTree>;
extern template class openvdb::Grid<openvdb::Vec3STree>;
extern template class openvdb::Grid<openvdb::Int32Tree>;
extern template class openvdb::Grid<openvdb::Int64Tree>;
extern template class openvdb::Grid<openvdb::MaskTree>;
