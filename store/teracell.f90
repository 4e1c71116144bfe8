! teracell for Fortran: grids of type tc_grid over the functions of teracell.h, which has the definitions.
!
!   use teracell
!   type(tc_grid) :: grid
!   integer(int8), allocatable :: cells(:,:,:)
!   call grid%open('stadium.tcell')
!   allocate(cells(64, 64, 64))
!   call grid%read([0_int64, 0_int64, 0_int64], cells)     ! cells(i, j, k) is the cell lo + (i - 1, j - 1, k - 1)
!
! Cells are counted from 0, as in all of teracell. An error prints its message and stops the program, unless the procedure takes
! an optional `status` and the caller gives it: then the caller decides, and tc_error_text() has the message. Assigning a grid to
! another one is not supported: both would close it. A kind of integers holds values as unsigned ones do: with
! int8, the id 200 reads as -56.
module teracell
  use, intrinsic :: iso_c_binding
  use, intrinsic :: iso_fortran_env, only: int8, int16, int32, int64, real64, error_unit
  implicit none
  private
  public :: tc_grid, tc_cells, tc_column_run, tc_error_text, tc_version_text
  public :: int8, int16, int32, int64, real64

  integer(c_int), parameter, public :: tc_ok = 0, tc_usage = 1, tc_io = 2, tc_format = 3, tc_memory = 4, &
    tc_stopped = 5, tc_internal = 6

  ! Exact counts of a material in a box.
  type, bind(c) :: tc_cells
    integer(c_int64_t) :: cells, cells_high
    real(c_double) :: volume
    integer(c_int64_t) :: lo(3), hi(3)
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

  type :: tc_grid
    private
    type(c_ptr) :: handle = c_null_ptr
  contains
    procedure, public :: open => grid_open
    procedure, public :: close => grid_close
    procedure, public :: levels => grid_levels
    procedure, public :: ray_axis => grid_ray_axis
    procedure, public :: units => grid_units
    procedure, public :: shape => grid_shape
    procedure, public :: planes => grid_planes
    procedure, public :: samples => grid_samples
    procedure, public :: materials => grid_materials
    procedure, public :: material => grid_material
    procedure, public :: stats => grid_stats
    procedure, public :: column => grid_column
    procedure, public :: uniform => grid_uniform
    procedure, private :: read_int8, read_int16, read_int32
    generic, public :: read => read_int8, read_int16, read_int32
    final :: grid_final
  end type

  interface
    function tc_open(path, grid) bind(c)
      import
      character(kind=c_char), intent(in) :: path(*)
      type(c_ptr), intent(out) :: grid
      integer(c_int) :: tc_open
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
    function tc_shape(grid, level, cells) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int), value :: level
      integer(c_int64_t), intent(out) :: cells(3)
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
    function tc_materials(grid, materials, count) bind(c)
      import
      type(c_ptr), value :: grid
      type(c_ptr), intent(out) :: materials
      integer(c_int64_t), intent(out) :: count
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
    function tc_column(grid, axis, a, b, from, to, runs, capacity, count) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int), value :: axis
      integer(c_int64_t), value :: a, b, from, to, capacity
      type(tc_column_run), intent(out) :: runs(*)
      integer(c_int64_t), intent(out) :: count
      integer(c_int) :: tc_column
    end function
    function tc_stats(grid, lo, hi, by_material, count) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int64_t), intent(in) :: lo(3), hi(3)
      type(tc_cells), intent(out) :: by_material(*)
      integer(c_int64_t), value :: count
      integer(c_int) :: tc_stats
    end function
    function tc_uniform(grid, level, lo, hi, uniform, material) bind(c)
      import
      type(c_ptr), value :: grid
      integer(c_int), value :: level
      integer(c_int64_t), intent(in) :: lo(3), hi(3)
      integer(c_int), intent(out) :: uniform
      integer(c_int32_t), intent(inout) :: material
      integer(c_int) :: tc_uniform
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

  subroutine grid_final(self)
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

  function grid_shape(self, level) result(cells)
    class(tc_grid), intent(in) :: self
    integer, intent(in), optional :: level
    integer(int64) :: cells(3)
    call finish(tc_shape(self%handle, level_of(level), cells))
  end function

  ! The planes between the cells along an axis (1, 2 or 3): planes(i) is the lower side of cell i - 1.
  function grid_planes(self, axis, level) result(out)
    class(tc_grid), intent(in) :: self
    integer, intent(in) :: axis
    integer, intent(in), optional :: level
    real(real64), allocatable :: out(:)
    integer(int64) :: cells(3)
    cells = self%shape(level)
    allocate(out(cells(axis) + 1))
    call finish(tc_planes(self%handle, level_of(level), axis - 1, 0_int64, cells(axis) + 1, out))
  end function

  function grid_samples(self, axis, level) result(out)
    class(tc_grid), intent(in) :: self
    integer, intent(in) :: axis
    integer, intent(in), optional :: level
    real(real64), allocatable :: out(:)
    integer(int64) :: cells(3)
    cells = self%shape(level)
    allocate(out(cells(axis)))
    call finish(tc_samples(self%handle, level_of(level), axis - 1, 0_int64, cells(axis), out))
  end function

  ! How many materials there are. Ids begin at 0.
  integer function grid_materials(self)
    class(tc_grid), intent(in) :: self
    type(c_ptr) :: all
    integer(int64) :: count
    call finish(tc_materials(self%handle, all, count))
    grid_materials = int(count)
  end function

  ! The name of a material by its id.
  function grid_material(self, id) result(name)
    class(tc_grid), intent(in) :: self
    integer, intent(in) :: id
    character(len=:), allocatable :: name
    type(c_ptr) :: all
    type(c_material), pointer :: list(:)
    integer(int64) :: count
    call finish(tc_materials(self%handle, all, count))
    if (id < 0 .or. id >= count) then
      write (error_unit, '(a, i0, a, i0)') 'teracell: material: expected an id from 0 to ', count - 1, ', found ', id
      error stop 1
    end if
    call c_f_pointer(all, list, [count])
    name = text_of(list(id + 1)%name)
  end function

  ! Exact counts of level 0 in a box: out(id + 1).
  subroutine grid_stats(self, lo, hi, out, status)
    class(tc_grid), intent(in) :: self
    integer(int64), intent(in) :: lo(3), hi(3)
    type(tc_cells), intent(out), allocatable :: out(:)
    integer, intent(out), optional :: status
    allocate(out(self%materials()))
    call finish(tc_stats(self%handle, lo, hi, out, size(out, kind=int64)), status)
  end subroutine

  ! The column of level 0 along an axis (1, 2 or 3) through the cells a and b of the other two axes.
  subroutine grid_column(self, axis, a, b, runs, status)
    class(tc_grid), intent(in) :: self
    integer, intent(in) :: axis
    integer(int64), intent(in) :: a, b
    type(tc_column_run), intent(out), allocatable :: runs(:)
    integer, intent(out), optional :: status
    integer(int64) :: count
    integer(c_int) :: found
    count = 16
    do
      if (allocated(runs)) deallocate(runs)
      allocate(runs(count))
      found = tc_column(self%handle, axis - 1, a, b, 0_int64, huge(0_int64), runs, size(runs, kind=int64), count)
      if (found /= tc_ok .or. count <= size(runs)) exit
    end do
    if (found == tc_ok) runs = runs(:count)
    call finish(found, status)
  end subroutine

  ! The material of all cells of a box, or -1 if they differ.
  integer function grid_uniform(self, lo, hi, level)
    class(tc_grid), intent(in) :: self
    integer(int64), intent(in) :: lo(3), hi(3)
    integer, intent(in), optional :: level
    integer(c_int) :: one
    integer(c_int32_t) :: material
    material = 0
    call finish(tc_uniform(self%handle, level_of(level), lo, hi, one, material))
    grid_uniform = merge(int(material), -1, one /= 0)
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

end module teracell
