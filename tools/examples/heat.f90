! Heat in a box of cells at the bottom of a grid, with a layer of ghost cells: explicit steps with a conductivity for each material.
!
!   gfortran heat.f90 $(pkg-config --cflags --libs teracell-fortran) -o heat && ./heat stadium.tcell
program heat
  use, intrinsic :: iso_fortran_env, only: error_unit
  use teracell
  implicit none
  integer, parameter :: n = 48, steps = 200
  type(tc_grid) :: grid
  integer(int8) :: cells(0:n + 1, 0:n + 1, 0:n + 1)
  real(real64), dimension(0:n + 1, 0:n + 1, 0:n + 1) :: t, k
  integer(int64) :: shape(3), lo(3)
  character(len=1000) :: path
  integer :: i, step

  if (command_argument_count() /= 1) then
    write (error_unit, '(a)') 'usage: heat GRID.tcell'
    stop 2
  end if
  call get_command_argument(1, path)
  call grid%open(trim(path))
  shape = grid%shape()
  lo = [(shape(1:2) - n) / 2, 0_int64]
  ! The box from lo, with one layer of ghost cells on each side; what lies outside the grid is material 0.
  call grid%read(lo - 1, cells, outside=0)
  print '(a, i0, a, i0, a)', 'solid cells: ', count(cells(1:n, 1:n, 1:n) /= 0), ' of ', n**3, ' at the bottom of the grid'

  k = merge(0.01_real64, 1.0_real64, cells == 0)  ! air conducts little
  t = 0
  t(0, :, :) = 1                                  ! hot at one side
  do step = 1, steps
    t(1:n, 1:n, 1:n) = t(1:n, 1:n, 1:n) + 0.1_real64 * ( &
      flow(t(0:n-1, 1:n, 1:n), k(0:n-1, 1:n, 1:n)) + flow(t(2:n+1, 1:n, 1:n), k(2:n+1, 1:n, 1:n)) + &
      flow(t(1:n, 0:n-1, 1:n), k(1:n, 0:n-1, 1:n)) + flow(t(1:n, 2:n+1, 1:n), k(1:n, 2:n+1, 1:n)) + &
      flow(t(1:n, 1:n, 0:n-1), k(1:n, 1:n, 0:n-1)) + flow(t(1:n, 1:n, 2:n+1), k(1:n, 1:n, 2:n+1)))
  end do
  do i = 1, n, 8
    print '(a, i3, a, f8.5)', 'x = ', i, ': ', sum(t(i, 1:n, 1:n)) / n**2
  end do

contains

  ! From a neighbour into each cell, by the harmonic mean of the two conductivities.
  function flow(t_next, k_next)
    real(real64), dimension(n, n, n), intent(in) :: t_next, k_next
    real(real64), dimension(n, n, n) :: flow
    flow = 2 * k_next * k(1:n, 1:n, 1:n) / (k_next + k(1:n, 1:n, 1:n)) * (t_next - t(1:n, 1:n, 1:n))
  end function
end program
