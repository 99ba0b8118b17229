// Simplifies a mesh by one of the policies of CGAL's Surface_mesh_simplification.
//
// cgal POLICY TARGET_FACES CALLS IN OUT: reads and writes the files of `meshes.py`, and prints, as
// JSON, the mean of the seconds of the processor that so many calls of `edge_collapse` took, and
// the memory before the mesh was there and at most during the first call.
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_probabilistic_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_probabilistic_triangle_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_triangle_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <CGAL/version.h>

#include <malloc.h>

#include <array>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace SMS = CGAL::Surface_mesh_simplification;
namespace PMP = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

// Stops at a number of faces; CGAL's own stops count edges.
struct FaceCount {
  std::size_t n;
  template <typename Cost, typename Profile>
  bool operator()(const Cost &, const Profile &profile, std::size_t, std::size_t) const {
    return profile.surface_mesh().number_of_faces() <= n;
  }
};

static double cpu_seconds() {
  timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return time.tv_sec + 1e-9 * time.tv_nsec;
}

// Bytes of a line of /proc/self/status.
static long status(const std::string &key) {
  std::ifstream file("/proc/self/status");
  std::string word;
  for (long value; file >> word;)
    if (word == key + ":" && file >> value) return value * 1024;
  return 0;
}

static Mesh read(const char *path) {
  std::ifstream file(path, std::ios::binary);
  std::uint64_t n[2] = {0, 0};
  file.read(reinterpret_cast<char *>(n), sizeof n);
  std::vector<std::array<double, 3>> places(n[0]);
  std::vector<std::array<std::uint32_t, 3>> corners(n[1]);
  file.read(reinterpret_cast<char *>(places.data()), n[0] * sizeof places[0]);
  file.read(reinterpret_cast<char *>(corners.data()), n[1] * sizeof corners[0]);
  if (!file) {
    std::cerr << path << ": not a whole mesh\n";
    std::exit(1);
  }
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> faces;
  for (auto &p : places) points.emplace_back(p[0], p[1], p[2]);
  for (auto &f : corners) faces.push_back({f[0], f[1], f[2]});
  // A Surface_mesh holds no vertex where surfaces touch: it is doubled.
  PMP::orient_polygon_soup(points, faces);
  Mesh mesh;
  PMP::polygon_soup_to_polygon_mesh(points, faces, mesh);
  return mesh;
}

static void write(Mesh &mesh, const char *path) {
  mesh.collect_garbage();
  std::ofstream file(path, std::ios::binary);
  std::uint64_t n[2] = {mesh.number_of_vertices(), mesh.number_of_faces()};
  file.write(reinterpret_cast<char *>(n), sizeof n);
  for (auto v : mesh.vertices()) {
    const Point &p = mesh.point(v);
    const double place[3] = {p.x(), p.y(), p.z()};
    file.write(reinterpret_cast<const char *>(place), sizeof place);
  }
  for (auto f : mesh.faces())
    for (auto v : mesh.vertices_around_face(mesh.halfedge(f))) {
      const std::uint32_t id = v.idx();
      file.write(reinterpret_cast<const char *>(&id), sizeof id);
    }
}

// As in CGAL's own examples: the placement of its quadrics turns no face over.
template <typename Policies>
static void garland_heckbert(Mesh &mesh, FaceCount stop) {
  Policies policies(mesh);
  SMS::Bounded_normal_change_placement<typename Policies::Get_placement> placement(
      policies.get_placement());
  SMS::edge_collapse(
      mesh, stop,
      CGAL::parameters::get_cost(policies.get_cost()).get_placement(placement));
}

static bool simplify(const std::string &policy, Mesh &mesh, FaceCount stop) {
  const SMS::LindstromTurk_cost<Mesh> cost;
  const SMS::LindstromTurk_placement<Mesh> placement;
  if (policy == "lindstrom_turk")
    SMS::edge_collapse(mesh, stop, CGAL::parameters::get_cost(cost).get_placement(placement));
  else if (policy == "lindstrom_turk_bounded")
    SMS::edge_collapse(mesh, stop,
                       CGAL::parameters::get_cost(cost).get_placement(placement).filter(
                           SMS::Bounded_normal_change_filter<>()));
  else if (policy == "plane")
    garland_heckbert<SMS::GarlandHeckbert_plane_policies<Mesh, Kernel>>(mesh, stop);
  else if (policy == "triangle")
    garland_heckbert<SMS::GarlandHeckbert_triangle_policies<Mesh, Kernel>>(mesh, stop);
  else if (policy == "probabilistic_plane")
    garland_heckbert<SMS::GarlandHeckbert_probabilistic_plane_policies<Mesh, Kernel>>(mesh, stop);
  else if (policy == "probabilistic_triangle")
    garland_heckbert<SMS::GarlandHeckbert_probabilistic_triangle_policies<Mesh, Kernel>>(mesh,
                                                                                         stop);
  else
    return false;
  return true;
}

int main(int argc, char **argv) {
  if (argc == 2 && std::string(argv[1]) == "--version") {
    std::cout << CGAL_VERSION_STR << '\n';
    return 0;
  }
  if (argc != 6) {
    std::cerr << "usage: cgal POLICY TARGET_FACES CALLS IN OUT\n";
    return 2;
  }
  const FaceCount stop{std::stoul(argv[2])};
  const int n_calls = std::stoi(argv[3]);
  const long before = status("VmRSS");
  Mesh mesh;
  double seconds = 0;
  long peak = 0;
  for (int call = 0; call < n_calls; ++call) {
    mesh = read(argv[4]);
    malloc_trim(0);
    if (call == 0) std::ofstream("/proc/self/clear_refs") << "5";
    const double start = cpu_seconds();
    if (!simplify(argv[1], mesh, stop)) {
      std::cerr << argv[1] << ": no such policy\n";
      return 2;
    }
    seconds += cpu_seconds() - start;
    if (call == 0) peak = status("VmHWM");
  }
  write(mesh, argv[5]);
  std::cout << "{\"cpu\": " << seconds / n_calls << ", \"before\": " << before
            << ", \"peak\": " << peak << "}\n";
}
