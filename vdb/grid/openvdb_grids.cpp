// SPDX-License-Identifier: Apache-2.0
#include "openvdb_grids.h"

template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
template class openvdb::tree::Tree<openvdb::Vec3STree::RootNodeType>;
template class openvdb::tree::Tree<openvdb::Int32Tree::RootNodeType>;
template class openvdb::tree::Tree<openvdb::Int64Tree::RootNodeType>;
template class openvdb::tree::Tree<openvdb::MaskTree::RootNodeType>;
template class openvdb::Grid<openvdb::FloatTree>;
template class openvdb::Grid<openvdb::Vec3STree>;
template class openvdb::Grid<openvdb::Int32Tree>;
template class openvdb::Grid<openvdb::Int64Tree>;
template class openvdb::Grid<openvdb::MaskTree>;
