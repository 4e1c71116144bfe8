! teracell for Fortran: grids of type tc_grid over the functions of teracell.h, which has the definitions.
!
!   use teracell
!   type(tc_grid) :: grid
!   integer(int8), allocatable :: cells(:,:,:)
!   call grid%open('stadium.tcell')
!   allocate(cells(64, 64, 64))
!   call grid%read([0_int64, 0_int64, 0_int64], cells)     ! cells(i, j, k) is the cell lo + (i - 1, j - 1, k - 1)
!
! Cells are counted from 0, as in all of teracell. An error prints its message and stops the program, unless the caller gives the
! optional `status`: then it is tc_ok or the kind of the error, and tc_error_text() has the message (in which axes are 0, 1, 2).
! After an assignment both variables have the grid, and it is closed when neither has it any more. Fortran does not tell this
! module of the copies that allocate(b, source=a) makes, so make none of a grid. A kind of integers holds values as unsigned ones
! do: with int8, the id 200 reads as -56.
module teracell
  use, intrinsic :: iso_c_binding
  use, intrinsic :: iso_fortran_env, only: int8, int16, int32, int64, real64, error_unit
  implicit none
  private
  public :: tc_grid, tc_cells, tc_link, tc_column_run, tc_part, tc_partition, tc_error_text, tc_version_text
  public :: int8, int16, int32, int64, real64

  integer(c_int), parameter, public :: tc_ok = 0, tc_usage = 1, tc_io = 2, tc_format = 3, tc_memory = 4, &
    tc_stopped = 5, tc_internal = 6

  ! Exact counts of a material in a box.
  type, bind(c) :: tc_cells
    integer(c_int64_t) :: cells, cells_high
    real(c_double) :: volume
    integer(c_int64_t) :: lo(3), hi(3)
  end type

  ! Between a cell and its upper neighbour: where the label of the one ends and that of the other begins, in 65536ths of the distance of
  ! their sample points; and the patch of the surface, -1 if none is known.
  type, bind(c) :: tc_link
    integer(c_int64_t) :: cell(3)
    integer(c_int32_t) :: end, begin
    integer(c_int64_t) :: patch
  end type

  ! Links that are being collected.
  type :: link_list
    type(tc_link), allocatable :: links(:)
    integer(int64) :: count = 0
  end type

  type, bind(c) :: tc_column_run
    integer(c_int64_t) :: from, to
    integer(c_int32_t) :: material
  end type

  type, bind(c) :: c_material
    type(c_ptr) :: name
    integer(c_int8_t) :: color(4)
    integer(c_int32_t) :: rank
  end type

  type, bind(c) :: c_patch
    type(c_ptr) :: name, body
    real(c_double) :: area
  end type

  type, bind(c) :: c_plan
    integer(c_int64_t) :: ranks, cells(3), align, halo
    real(c_double) :: total
    type(c_ptr) :: method, grid_hash
  end type

  type, bind(c) :: c_part
    integer(c_int64_t) :: lo(3), hi(3), halo_lo(3), halo_hi(3)
    real(c_double) :: weight
    type(c_ptr) :: neighbours
    integer(c_int64_t) :: count
  end type

  ! What a rank computes: the cells of level 0 from lo to below hi. It reads those from halo_lo to below halo_hi.
  type :: tc_part
    integer(int64) :: lo(3), hi(3), halo_lo(3), halo_hi(3)
    real(real64) :: weight                        ! the work in it
    integer(int64), allocatable :: neighbours(:)  ! ranks, ascending
  end type

  ! A file that `teracell partition` has written: parts(rank), for the ranks 0 to ranks - 1 of MPI.
  type :: tc_partition
    integer(int64) :: ranks = 0, cells(3) = 0, align = 0, halo = 0
    real(real64) :: total = 0                     ! the work in the whole grid
    character(len=:), allocatable :: method, grid_hash
    type(tc_part), allocatable :: parts(:)
  contains
    procedure, public :: read => partition_read
  end type

  type :: tc_grid
    private
    type(c_ptr) :: handle = c_null_ptr
  contains
    procedure, public :: open => grid_open
    procedure, public :: close => grid_close
    procedure, public :: levels => grid_levels
    procedure, public :: ray_axis => grid_ray_axis
    procedure, public :: units => grid_units
    procedure, public :: hash => grid_hash
    procedure, public :: shape => grid_shape
    procedure, public :: planes => grid_planes
    procedure, public :: samples => grid_samples
    procedure, public :: materials => grid_materials
    procedure, public :: material => grid_material
    procedure, public :: stats => grid_stats
    procedure, public :: column => grid_column
    procedure, public :: uniform => grid_uniform
    procedure, public :: fractions => grid_fractions
    procedure, public :: links => grid_links
    procedure, public :: patches => grid_patches
    procedure, public :: patch => grid_patch
    procedure, private :: read_int8, read_int16, read_int32
    generic, public :: read => read_int8, read_int16, read_int32
    procedure, private :: grid_assign
    generic, public :: assignment(=) => grid_assign
    final :: grid_final
  end type

  ! What C leaves as it is after an error is intent(inout): what is intent(out) would be undefined then.
  interface
    function tc_open(path, grid) bind(c)
      import
      character(kind=c_char), intent(in) :: path(*)
      type(c_ptr), intent(inout) :: grid
      integer(c_int) :: tc_open
    end function
    function tc_share(grid) bind(c)
      import
      type(c_ptr), value :: grid
      type(c_ptr) :: tc_share
    end function
    subroutine tc_close(grid) bind(c)
      import
      type(c_ptr), value :: grid
    end subroutine
    function tc_error() bind(c)
      import
      type(c_ptr) :: tc_error
    end function
    function tc_version() bind(c)
      import
      type(c_ptr) :: tc_version
    end function
    function tc_levels(grid) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int) :: tc_levels
    end function
    function tc_ray_axis(grid) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int) :: tc_ray_axis
    end function
    function tc_units(grid) bind(c)
      import
      type(c_ptr), value :: grid
      type(c_ptr) :: tc_units
    end function
    function tc_hash(grid) bind(c)
      import
      type(c_ptr), value :: grid
      type(c_ptr) :: tc_hash
    end function
    function tc_shape(grid, level, cells) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int), value :: level
      integer(c_int64_t), intent(inout) :: cells(3)
      integer(c_int) :: tc_shape
    end function
    function tc_planes(grid, level, axis, first, count, out) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int), value :: level, axis
      integer(c_int64_t), value :: first, count
      real(c_double), intent(out) :: out(*)
      integer(c_int) :: tc_planes
    end function
    function tc_samples(grid, level, axis, first, count, out) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int), value :: level, axis
      integer(c_int64_t), value :: first, count
      real(c_double), intent(out) :: out(*)
      integer(c_int) :: tc_samples
    end function
    function tc_material_count(grid) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int64_t) :: tc_material_count
    end function
    function tc_materials(grid, first, count, out, size) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int64_t), value :: first, count
      type(c_material), intent(out) :: out
      integer(c_size_t), value :: size
      integer(c_int) :: tc_materials
    end function
    function tc_read_box(grid, level, lo, hi, type, data, stride, outside, map, map_size, threads) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int), value :: level, type
      integer(c_int64_t), intent(in) :: lo(3), hi(3), stride(3)
      type(c_ptr), value :: data, map
      integer(c_int32_t), value :: outside
      integer(c_int64_t), value :: map_size
      integer(c_int), value :: threads
      integer(c_int) :: tc_read_box
    end function
    function tc_patch_count(grid) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int64_t) :: tc_patch_count
    end function
    function tc_patches(grid, first, count, out, size) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int64_t), value :: first, count
      type(c_patch), intent(out) :: out
      integer(c_size_t), value :: size
      integer(c_int) :: tc_patches
    end function
    function tc_links(grid, axis, lo, hi, visit, user) bind(c)
      import
      type(c_ptr), value :: grid, user
      type(c_funptr), value :: visit
      integer(c_int), value :: axis
      integer(c_int64_t), intent(in) :: lo(3), hi(3)
      integer(c_int) :: tc_links
    end function
    function tc_column(grid, axis, a, b, from, to, runs, size, capacity, count) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int), value :: axis
      integer(c_int64_t), value :: a, b, from, to, capacity
      type(tc_column_run), intent(out) :: runs(*)
      integer(c_size_t), value :: size
      integer(c_int64_t), intent(out) :: count
      integer(c_int) :: tc_column
    end function
    function tc_stats(grid, lo, hi, by_material, size, count) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int64_t), intent(in) :: lo(3), hi(3)
      type(tc_cells), intent(out) :: by_material(*)
      integer(c_size_t), value :: size
      integer(c_int64_t), value :: count
      integer(c_int) :: tc_stats
    end function
    function tc_uniform(grid, level, lo, hi, uniform, material) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int), value :: level
      integer(c_int64_t), intent(in) :: lo(3), hi(3)
      integer(c_int), intent(inout) :: uniform
      integer(c_int32_t), intent(inout) :: material
      integer(c_int) :: tc_uniform
    end function
    function tc_fractions(grid, material, lo, hi, data, stride, outside, threads) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int32_t), value :: material
      integer(c_int64_t), intent(in) :: lo(3), hi(3), stride(3)
      type(c_ptr), value :: data
      real(c_double), value :: outside
      integer(c_int), value :: threads
      integer(c_int) :: tc_fractions
    end function
    function tc_partition_open(path, partition) bind(c)
      import
      character(kind=c_char), intent(in) :: path(*)
      type(c_ptr), intent(out) :: partition
      integer(c_int) :: tc_partition_open
    end function
    subroutine tc_partition_close(partition) bind(c)
      import
      type(c_ptr), value :: partition
    end subroutine
    function tc_partition_plan(partition, plan, size) bind(c)
      import
      type(c_ptr), value :: partition
      type(c_plan), intent(out) :: plan
      integer(c_size_t), value :: size
      integer(c_int) :: tc_partition_plan
    end function
    function tc_partition_part(partition, rank, part, size) bind(c)
      import
      type(c_ptr), value :: partition
      integer(c_int64_t), value :: rank
      type(c_part), intent(out) :: part
      integer(c_size_t), value :: size
      integer(c_int) :: tc_partition_part
    end function
    function c_strlen(text) bind(c, name='strlen')
      import
      type(c_ptr), value :: text
      integer(c_size_t) :: c_strlen
    end function
  end interface

contains

  function text_of(c) result(text)
    type(c_ptr), intent(in) :: c
    character(len=:), allocatable :: text
    character(kind=c_char), pointer :: chars(:)
    integer :: i
    call c_f_pointer(c, chars, [c_strlen(c)])
    allocate(character(len=size(chars)) :: text)
    do i = 1, size(chars)
      text(i:i) = chars(i)
    end do
  end function

  function tc_error_text() result(text)
    character(len=:), allocatable :: text
    text = text_of(tc_error())
  end function

  function tc_version_text() result(text)
    character(len=:), allocatable :: text
    text = text_of(tc_version())
  end function

  ! Hands a status to the caller, or stops the program.
  subroutine finish(found, status)
    integer(c_int), intent(in) :: found
    integer, intent(out), optional :: status
    if (present(status)) then
      status = found
    else if (found /= tc_ok) then
      write (error_unit, '(2a)') 'teracell: ', tc_error_text()
      flush (error_unit)  ! or it comes after what the runtime says of error stop
      error stop 1
    end if
  end subroutine

  subroutine grid_open(self, path, status)
    class(tc_grid), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer, intent(out), optional :: status
    call self%close()
    call finish(tc_open(path // c_null_char, self%handle), status)
  end subroutine

  subroutine grid_close(self)
    class(tc_grid), intent(inout) :: self
    call tc_close(self%handle)
    self%handle = c_null_ptr
  end subroutine

  ! Elemental, so that arrays of grids, and structures that have one, are assigned in this way, too.
  impure elemental subroutine grid_assign(self, from)
    class(tc_grid), intent(inout) :: self
    type(tc_grid), intent(in) :: from
    type(c_ptr) :: shared
    shared = tc_share(from%handle)  ! before closing: it may be the same one
    call self%close()
    self%handle = shared
  end subroutine

  impure elemental subroutine grid_final(self)
    type(tc_grid), intent(inout) :: self
    call self%close()
  end subroutine

  integer function grid_levels(self)
    class(tc_grid), intent(in) :: self
    grid_levels = tc_levels(self%handle)
  end function

  ! 1, 2 or 3 for x, y, z, as array dimensions are counted here.
  integer function grid_ray_axis(self)
    class(tc_grid), intent(in) :: self
    grid_ray_axis = tc_ray_axis(self%handle) + 1
  end function

  function grid_units(self) result(text)
    class(tc_grid), intent(in) :: self
    character(len=:), allocatable :: text
    text = text_of(tc_units(self%handle))
  end function

  ! 32 hexadecimal digits that stand for the content of the file.
  function grid_hash(self) result(text)
    class(tc_grid), intent(in) :: self
    character(len=:), allocatable :: text
    text = text_of(tc_hash(self%handle))
  end function

  ! Of an error, the result is 0.
  function grid_shape(self, level, status) result(cells)
    class(tc_grid), intent(in) :: self
    integer, intent(in), optional :: level
    integer, intent(out), optional :: status
    integer(int64) :: cells(3)
    cells = 0
    call finish(tc_shape(self%handle, level_of(level), cells), status)
  end function

  ! The planes between the cells along an axis (1, 2 or 3): planes(i) is the lower side of cell i - 1. Of an error, there are none.
  function grid_planes(self, axis, level, status) result(out)
    class(tc_grid), intent(in) :: self
    integer, intent(in) :: axis
    integer, intent(in), optional :: level
    integer, intent(out), optional :: status
    real(real64), allocatable :: out(:)
    integer(c_int) :: found
    call allocate_along(self, axis, level, 1, out)
    found = tc_planes(self%handle, level_of(level), axis - 1, 0_int64, size(out, kind=int64), out)
    if (found /= tc_ok) out = [real(real64) ::]
    call finish(found, status)
  end function

  ! The sample points of the cells along an axis: samples(i) is that of cell i - 1. Of an error, there are none.
  function grid_samples(self, axis, level, status) result(out)
    class(tc_grid), intent(in) :: self
    integer, intent(in) :: axis
    integer, intent(in), optional :: level
    integer, intent(out), optional :: status
    real(real64), allocatable :: out(:)
    integer(c_int) :: found
    call allocate_along(self, axis, level, 0, out)
    found = tc_samples(self%handle, level_of(level), axis - 1, 0_int64, size(out, kind=int64), out)
    if (found /= tc_ok) out = [real(real64) ::]
    call finish(found, status)
  end function

  ! An element for each cell along an axis, and `more`; none if there is no such axis or level, which the next call will say.
  subroutine allocate_along(self, axis, level, more, out)
    class(tc_grid), intent(in) :: self
    integer, intent(in) :: axis, more
    integer, intent(in), optional :: level
    real(real64), intent(out), allocatable :: out(:)
    integer(int64) :: cells(3)
    integer :: status
    cells = self%shape(level, status)
    if (status == tc_ok .and. axis >= 1 .and. axis <= 3) then
      allocate(out(cells(axis) + more))
    else
      allocate(out(0))
    end if
  end subroutine

  ! How many materials there are. Ids begin at 0.
  integer function grid_materials(self)
    class(tc_grid), intent(in) :: self
    grid_materials = int(tc_material_count(self%handle))
  end function

  ! The name of a material by its id; '' after an error.
  function grid_material(self, id, status) result(name)
    class(tc_grid), intent(in) :: self
    integer, intent(in) :: id
    integer, intent(out), optional :: status
    character(len=:), allocatable :: name
    type(c_material) :: material
    integer(c_int) :: found
    name = ''
    found = tc_materials(self%handle, int(id, int64), 1_int64, material, c_sizeof(material))
    if (found == tc_ok) name = text_of(material%name)
    call finish(found, status)
  end function

  ! Exact counts of level 0 in a box: out(id + 1).
  subroutine grid_stats(self, lo, hi, out, status)
    class(tc_grid), intent(in) :: self
    integer(int64), intent(in) :: lo(3), hi(3)
    type(tc_cells), intent(out), allocatable :: out(:)
    integer, intent(out), optional :: status
    type(tc_cells) :: one
    allocate(out(self%materials()))
    call finish(tc_stats(self%handle, lo, hi, out, c_sizeof(one), size(out, kind=int64)), status)
  end subroutine

  ! The column of level 0 along an axis (1, 2 or 3) through the cells a and b of the other two axes.
  subroutine grid_column(self, axis, a, b, runs, status)
    class(tc_grid), intent(in) :: self
    integer, intent(in) :: axis
    integer(int64), intent(in) :: a, b
    type(tc_column_run), intent(out), allocatable :: runs(:)
    integer, intent(out), optional :: status
    type(tc_column_run) :: one
    integer(int64) :: count
    integer(c_int) :: found
    count = 16
    do
      if (allocated(runs)) deallocate(runs)
      allocate(runs(count))
      found = tc_column(self%handle, axis - 1, a, b, 0_int64, huge(0_int64), runs, c_sizeof(one), size(runs, kind=int64), &
                        count)
      if (found /= tc_ok .or. count <= size(runs)) exit
    end do
    if (found == tc_ok) runs = runs(:count)
    call finish(found, status)
  end subroutine

  ! The material of all cells of a box; -1 if they differ, and after an error.
  integer function grid_uniform(self, lo, hi, level, status)
    class(tc_grid), intent(in) :: self
    integer(int64), intent(in) :: lo(3), hi(3)
    integer, intent(in), optional :: level
    integer, intent(out), optional :: status
    integer(c_int) :: one
    integer(c_int32_t) :: material
    one = 0
    material = 0
    call finish(tc_uniform(self%handle, level_of(level), lo, hi, one, material), status)
    grid_uniform = merge(int(material), -1, one /= 0)
  end function

  ! Fills `shares` with the share of a material, from 0 to 1, in each cell of the box of its shape that begins at the cell `lo` of level 0,
  ! counted from 0. `material` is an id, which begin at 0.
  subroutine grid_fractions(self, material, lo, shares, outside, threads, status)
    class(tc_grid), intent(in) :: self
    integer, intent(in) :: material
    integer(int64), intent(in) :: lo(3)
    real(real64), intent(out), target, contiguous :: shares(:, :, :)
    real(real64), intent(in), optional :: outside
    integer, intent(in), optional :: threads
    integer, intent(out), optional :: status
    integer(int64) :: n(3)
    real(c_double) :: fill
    integer(c_int) :: workers
    n = shape(shares, kind=int64)
    fill = 0
    if (present(outside)) fill = outside
    workers = 0
    if (present(threads)) workers = int(threads, c_int)
    call finish(tc_fractions(self%handle, int(material, c_int32_t), lo, lo + n, c_loc(shares), [1_int64, n(1), n(1) * n(2)], fill, &
                             workers), status)
  end subroutine

  ! How many patches there are. Their numbers are 0 to this less 1.
  integer function grid_patches(self)
    class(tc_grid), intent(in) :: self
    grid_patches = int(tc_patch_count(self%handle))
  end function

  ! The name of a patch by its number; '' after an error.
  function grid_patch(self, number, status) result(name)
    class(tc_grid), intent(in) :: self
    integer, intent(in) :: number
    integer, intent(out), optional :: status
    character(len=:), allocatable :: name
    type(c_patch) :: patch
    integer(c_int) :: found
    name = ''
    found = tc_patches(self%handle, int(number, int64), 1_int64, patch, c_sizeof(patch))
    if (found == tc_ok) name = text_of(patch%name)
    call finish(found, status)
  end function

  ! The links along an axis (1, 2, 3 for x, y, z) whose cells lie from lo to below hi, in no particular order.
  subroutine grid_links(self, axis, lo, hi, links, status)
    class(tc_grid), intent(in) :: self
    integer, intent(in) :: axis
    integer(int64), intent(in) :: lo(3), hi(3)
    type(tc_link), intent(out), allocatable :: links(:)
    integer, intent(out), optional :: status
    type(link_list), target :: list
    integer(c_int) :: found
    allocate(list%links(64))
    found = tc_links(self%handle, int(axis - 1, c_int), lo, hi, c_funloc(add_link), c_loc(list))
    if (found == tc_ok) links = list%links(:list%count)
    call finish(found, status)
  end subroutine

  integer(c_int) function add_link(user, link) bind(c)
    type(c_ptr), value :: user
    type(tc_link), intent(in) :: link
    type(link_list), pointer :: list
    type(tc_link), allocatable :: more(:)
    call c_f_pointer(user, list)
    if (list%count == size(list%links)) then
      allocate(more(2 * list%count))
      more(:list%count) = list%links
      call move_alloc(more, list%links)
    end if
    list%count = list%count + 1
    list%links(list%count) = link
    add_link = 0
  end function

  integer(c_int) function level_of(level)
    integer, intent(in), optional :: level
    level_of = 0
    if (present(level)) level_of = level
  end function

  subroutine read_any(self, lo, n, bytes, data, level, outside, map, threads, status)
    class(tc_grid), intent(in) :: self
    integer(int64), intent(in) :: lo(3), n(3)
    integer(c_int), intent(in) :: bytes
    type(c_ptr), intent(in) :: data
    integer, intent(in), optional :: level, outside, threads
    integer(c_int32_t), intent(in), optional, target :: map(:)
    integer, intent(out), optional :: status
    integer(c_int32_t), allocatable, target :: values(:)
    type(c_ptr) :: values_at
    integer(c_int32_t) :: fill
    integer(c_int) :: workers
    values_at = c_null_ptr
    if (present(map)) then
      allocate(values, source=map)
      values_at = c_loc(values)
    else
      allocate(values(0))
    end if
    fill = 0
    if (present(outside)) fill = int(outside, c_int32_t)
    workers = 0
    if (present(threads)) workers = int(threads, c_int)
    call finish(tc_read_box(self%handle, level_of(level), lo, lo + n, bytes, data, [1_int64, n(1), n(1) * n(2)], fill, &
                            values_at, size(values, kind=int64), workers), status)
  end subroutine

  ! Fills `cells` with the box of its shape that begins at the cell `lo`, counted from 0. map(id + 1) is the value of a material.
  subroutine read_int8(self, lo, cells, level, outside, map, threads, status)
    class(tc_grid), intent(in) :: self
    integer(int64), intent(in) :: lo(3)
    integer(int8), intent(out), target, contiguous :: cells(:, :, :)
    integer, intent(in), optional :: level, outside, threads
    integer(c_int32_t), intent(in), optional, target :: map(:)
    integer, intent(out), optional :: status
    call read_any(self, lo, shape(cells, kind=int64), 1_c_int, c_loc(cells), level, outside, map, threads, status)
  end subroutine

  subroutine read_int16(self, lo, cells, level, outside, map, threads, status)
    class(tc_grid), intent(in) :: self
    integer(int64), intent(in) :: lo(3)
    integer(int16), intent(out), target, contiguous :: cells(:, :, :)
    integer, intent(in), optional :: level, outside, threads
    integer(c_int32_t), intent(in), optional, target :: map(:)
    integer, intent(out), optional :: status
    call read_any(self, lo, shape(cells, kind=int64), 2_c_int, c_loc(cells), level, outside, map, threads, status)
  end subroutine

  subroutine read_int32(self, lo, cells, level, outside, map, threads, status)
    class(tc_grid), intent(in) :: self
    integer(int64), intent(in) :: lo(3)
    integer(int32), intent(out), target, contiguous :: cells(:, :, :)
    integer, intent(in), optional :: level, outside, threads
    integer(c_int32_t), intent(in), optional, target :: map(:)
    integer, intent(out), optional :: status
    call read_any(self, lo, shape(cells, kind=int64), 4_c_int, c_loc(cells), level, outside, map, threads, status)
  end subroutine

  ! After an error, the partition has no parts.
  subroutine partition_read(self, path, status)
    class(tc_partition), intent(inout) :: self
    character(len=*), intent(in) :: path
    integer, intent(out), optional :: status
    type(c_ptr) :: handle
    type(c_plan) :: plan
    integer(c_int) :: found
    integer(int64) :: rank
    if (allocated(self%parts)) deallocate(self%parts)
    self%ranks = 0
    found = tc_partition_open(path // c_null_char, handle)
    if (found == tc_ok) found = tc_partition_plan(handle, plan, c_sizeof(plan))
    if (found == tc_ok) then
      self%ranks = plan%ranks
      self%cells = plan%cells
      self%align = plan%align
      self%halo = plan%halo
      self%total = plan%total
      self%method = text_of(plan%method)
      self%grid_hash = text_of(plan%grid_hash)
      allocate(self%parts(0:plan%ranks - 1))
      do rank = 0, plan%ranks - 1
        if (found == tc_ok) call part_read(handle, rank, self%parts(rank), found)
      end do
      call tc_partition_close(handle)
    end if
    call finish(found, status)
  end subroutine

  subroutine part_read(handle, rank, part, found)
    type(c_ptr), intent(in) :: handle
    integer(int64), intent(in) :: rank
    type(tc_part), intent(out) :: part
    integer(c_int), intent(out) :: found
    type(c_part) :: c
    integer(c_int64_t), pointer :: ranks(:)
    found = tc_partition_part(handle, rank, c, c_sizeof(c))
    if (found /= tc_ok) return
    part%lo = c%lo
    part%hi = c%hi
    part%halo_lo = c%halo_lo
    part%halo_hi = c%halo_hi
    part%weight = c%weight
    allocate(part%neighbours(c%count))
    if (c%count == 0) return
    call c_f_pointer(c%neighbours, ranks, [c%count])
    part%neighbours = ranks
  end subroutine

end module teracell
