! The same as patches.cpp through the Fortran module.
program patches
  use teracell
  implicit none
  type(tc_grid) :: grid
  integer :: i
  character(len=1000) :: path

  call get_command_argument(1, path)
  call grid%open(trim(path))
  do i = 0, grid%patches() - 1
    print '(a)', grid%patch(i)
  end do
end program
