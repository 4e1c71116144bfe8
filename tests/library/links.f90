! The same as links.cpp through the Fortran module.
program links
  use teracell
  use, intrinsic :: iso_fortran_env, only: input_unit
  implicit none
  type(tc_grid) :: grid
  integer :: axis, status, i
  integer(int64) :: lo(3), hi(3)
  type(tc_link), allocatable :: found(:)
  character(len=1000) :: path

  call get_command_argument(1, path)
  call grid%open(trim(path))
  do
    read (input_unit, *, iostat=status) axis, lo, hi
    if (status /= 0) exit
    call grid%links(axis + 1, lo, hi, found)
    do i = 1, size(found)
      print *, found(i)%cell, found(i)%end, found(i)%begin, found(i)%patch
    end do
  end do
end program
